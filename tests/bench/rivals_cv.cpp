/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/bench/rivals_cv.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc.hpp>

#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "base/guard.hpp"

namespace
{

const int RUNGS = 33;

double now()
{
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

/* Rungs spread evenly in the logarithm. */
double rung(int k, double low, double high)
{
    return low * std::pow(high / low, (double)k / (RUNGS - 1));
}

cv::Mat rgb_of(const rival_photo *photo)
{
    return cv::Mat(photo->height, photo->width, CV_32FC3, photo->rgb);
}

cv::Mat grey_of(const rival_photo *photo)
{
    cv::Mat grey;
    cv::cvtColor(rgb_of(photo), grey, cv::COLOR_RGB2GRAY);
    return grey;
}

/* Runs the ladder; returns the mean time of a rung. */
double climb(const std::function<cv::Mat(int)> &edges_at, cv::Mat &strength)
{
    double seconds = 0;
    strength.setTo(0);
    for (int k = 0; k < RUNGS; k++) {
        const double start = now();
        const cv::Mat on = edges_at(k);
        seconds += now() - start;
        strength.setTo((k + 1.0) / (RUNGS + 1.0) + 1e-6, on);
    }
    return seconds / RUNGS;
}

} // namespace

tz_status rival_canny(tz_ctx *ctx, const rival_photo *photo, double sigma, bool colour,
                      float *strength, double *seconds)
{
    return tz_guard(ctx, "canny", [&]() -> tz_status {
        cv::Mat out(photo->height, photo->width, CV_32F, strength), soft, dx, dy;
        const double start = now();
        /* 16 steps of a byte's one; what is lost at the largest gradients saturates */
        cv::GaussianBlur(colour ? rgb_of(photo) : grey_of(photo), soft, cv::Size(),
                         sigma);
        cv::Sobel(soft, dx, CV_32F, 1, 0, 3, 16 * 255);
        cv::Sobel(soft, dy, CV_32F, 0, 1, 3, 16 * 255);
        dx.convertTo(dx, CV_16S);
        dy.convertTo(dy, CV_16S);
        const double before = now() - start;
        *seconds = before + climb(
                                [&](int k) {
                                    const double high = 16 * rung(k, 4, 600);
                                    cv::Mat on;
                                    cv::Canny(dx, dy, on, 0.4 * high, high, true);
                                    return on;
                                },
                                out);
        return TZ_OK;
    });
}

tz_status rival_edge_drawing(tz_ctx *ctx, const rival_photo *photo, int op, double sigma,
                             float *strength, double *seconds)
{
    return tz_guard(ctx, "edge drawing", [&]() -> tz_status {
        cv::Mat out(photo->height, photo->width, CV_32F, strength), grey;
        grey_of(photo).convertTo(grey, CV_8U, 255);
        auto drawing = cv::ximgproc::createEdgeDrawing();
        drawing->params.EdgeDetectionOperator = op;
        drawing->params.Sigma = (float)sigma;
        *seconds = climb(
            [&](int k) {
                /* the operators' weights sum to 3, 4 and 16 */
                const double weight = op == 0 ? 3 : op == 1 ? 4 : 16;
                drawing->params.GradientThresholdValue =
                    (int)std::lround(weight * rung(k, 2, 150));
                cv::Mat on;
                drawing->detectEdges(grey);
                drawing->getEdgeImage(on);
                return on;
            },
            out);
        return TZ_OK;
    });
}

tz_status rival_forest(tz_ctx *ctx, const rival_photo *photo, const char *model,
                       float *response, double *seconds)
{
    return tz_guard(ctx, "OpenCV's forest", [&]() -> tz_status {
        /* reading takes seconds: once a model */
        static std::map<std::string, cv::Ptr<cv::ximgproc::StructuredEdgeDetection>>
            known;
        auto &forest = known[model];
        if (!forest)
            forest = cv::ximgproc::createStructuredEdgeDetection(model);
        cv::Mat edges, out(photo->height, photo->width, CV_32F, response);
        const double start = now();
        forest->detectEdges(rgb_of(photo), edges);
        *seconds = now() - start;
        edges.copyTo(out);
        return TZ_OK;
    });
}
