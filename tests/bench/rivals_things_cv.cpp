/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/bench/rivals_cv.h"

#include <opencv2/imgproc.hpp>

#include <chrono>

#include "base/guard.hpp"

tz_status rival_watershed(tz_ctx *ctx, const rival_photo *photo, double share,
                          bool inverted, int32_t *label, int32_t *labels, double *seconds)
{
    return tz_guard(ctx, "watershed", [&]() -> tz_status {
        using namespace std::chrono;
        const auto start = steady_clock::now();
        cv::Mat rgb(photo->height, photo->width, CV_32FC3, photo->rgb), bytes, grey, on;
        rgb.convertTo(bytes, CV_8U, 255);
        cv::cvtColor(bytes, grey, cv::COLOR_RGB2GRAY);
        cv::threshold(grey, on, 0, 255,
                      (inverted ? cv::THRESH_BINARY_INV : cv::THRESH_BINARY) +
                          cv::THRESH_OTSU);
        const cv::Mat three = cv::Mat::ones(3, 3, CV_8U);
        cv::Mat opened, background, distance, foreground, unknown, markers;
        cv::morphologyEx(on, opened, cv::MORPH_OPEN, three, cv::Point(-1, -1), 2);
        cv::dilate(opened, background, three, cv::Point(-1, -1), 3);
        cv::distanceTransform(opened, distance, cv::DIST_L2, 5);
        double most;
        cv::minMaxLoc(distance, nullptr, &most);
        cv::threshold(distance, foreground, share * most, 255, 0);
        foreground.convertTo(foreground, CV_8U);
        cv::subtract(background, foreground, unknown);
        *labels = cv::connectedComponents(foreground, markers) - 1;
        markers += 1;
        markers.setTo(0, unknown);
        cv::watershed(bytes, markers);
        *seconds = duration<double>(steady_clock::now() - start).count();
        for (int y = 0; y < photo->height; y++)
            for (int x = 0; x < photo->width; x++) {
                /* -1: lines; 1: background; the things from 2 on */
                const int m = markers.at<int32_t>(y, x);
                label[(size_t)y * photo->width + x] = m > 1 ? m - 2 : -1;
            }
        return TZ_OK;
    });
}
