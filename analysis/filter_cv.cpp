// SPDX-License-Identifier: Apache-2.0
#include "analysis/filter_cv.h"

#include <opencv2/imgproc.hpp>

#include "base/guard.hpp"

extern "C" tz_status tz_cv_blur(tz_ctx *ctx, float *src, float *dst, int32_t width,
                                int32_t height, int32_t y0, int32_t y1, double sigma)
{
    return tz_guard(ctx, "blur", [&]() -> tz_status {
        cv::Mat s(height, width, CV_32F, src), d(height, width, CV_32F, dst);
        cv::Mat rows = d.rowRange(y0, y1);
        int size = 2 * cvCeil(3 * sigma) + 1;
        cv::GaussianBlur(s.rowRange(y0, y1), rows, cv::Size(size, size), sigma, sigma,
                         cv::BORDER_REFLECT_101);
        return TZ_OK;
    });
}

extern "C" tz_status tz_cv_autocorrelation(tz_ctx *ctx, const float *src, int32_t width,
                                           int32_t height, int32_t mx, int32_t my,
                                           float *out)
{
    return tz_guard(ctx, "autocorrelation", [&]() -> tz_status {
        int w = cv::getOptimalDFTSize(width + mx), h = cv::getOptimalDFTSize(height + my);
        cv::Mat m = cv::Mat::zeros(h, w, CV_32F), f;
        for (int y = 0; y < height; y++)
            std::copy(src + (size_t)y * width, src + (size_t)(y + 1) * width,
                      m.ptr<float>(y));
        cv::dft(m, f, 0, height);
        cv::mulSpectrums(f, f, f, 0, true);
        cv::dft(f, m, cv::DFT_INVERSE | cv::DFT_SCALE);
        for (int y = -my; y <= my; y++)
            for (int x = 0; x <= mx; x++)
                *out++ = m.at<float>(y < 0 ? y + h : y, x);
        return TZ_OK;
    });
}
