/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/analysis/opencv_forest.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc.hpp>

#include <vector>

namespace
{

/* Triangle of that radius, by the filter that the detector calls. */
void blur(const cv::Mat &in, int radius, float *out)
{
    std::vector<float> kernel;
    for (int i = -radius; i <= radius; i++)
        kernel.push_back((float)(radius + 1 - std::abs(i)) /
                         (float)((radius + 1) * (radius + 1)));
    cv::Mat result;
    cv::sepFilter2D(in, result, -1, kernel, kernel);
    result.copyTo(cv::Mat(in.rows, in.cols, in.type(), out));
}

} // namespace

void opencv_channels(float *rgb, int32_t width, int32_t height, float *regular,
                     float *coarse)
{
    cv::Mat padded, channels;
    cv::copyMakeBorder(cv::Mat(height, width, CV_32FC3, rgb), padded, 8, 8, 8, 8,
                       cv::BORDER_REFLECT);
    cv::ximgproc::createRFFeatureGetter()->getFeatures(padded, channels, 4, 0, 2, 13, 4);
    blur(channels, 1, regular);
    blur(channels, 4, coarse);
}

void opencv_edges(const char *model, float *rgb, int32_t width, int32_t height,
                  float *response)
{
    cv::Mat edges;
    cv::ximgproc::createStructuredEdgeDetection(model)->detectEdges(
        cv::Mat(height, width, CV_32FC3, rgb), edges);
    edges.copyTo(cv::Mat(height, width, CV_32F, response));
}
