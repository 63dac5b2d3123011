/* SPDX-License-Identifier: Apache-2.0 */
/* The cloning module: what synthesis/clone_module.h says, all by stock OpenCV calls. */
#include "synthesis/clone_module.h"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include <cmath>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

namespace
{

/* First line only: messages are one line. */
int fail(int code, const std::string &text, char *why, size_t n)
{
    std::snprintf(why, n, "%s", text.substr(0, text.find('\n')).c_str());
    return code;
}

template <class F>
int guard(char *why, size_t n, F &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        std::snprintf(why, n, "out of memory");
        return 2;
    } catch (const cv::Exception &e) {
        return fail(e.code == cv::Error::StsNoMem ? 2 : 1, e.what(), why, n);
    } catch (const std::exception &e) {
        return fail(1, e.what(), why, n);
    } catch (...) {
        std::snprintf(why, n, "unknown exception");
        return 1;
    }
}

int paste(const tz_clone_patch *patch, const tz_clone_picture *picture)
{
    cv::Mat canvas(picture->height, picture->width, CV_8UC3, picture->px);
    const cv::Mat photo(patch->photo.height, patch->photo.width, CV_8UC3,
                        patch->photo.px);
    const cv::Rect room(2, 2, canvas.cols - 4, canvas.rows - 4);

    /* the patch's own little picture: its box and a rim, since seamlessClone clears the
     * outermost pixels of the mask */
    std::vector<cv::Point2f> outline;
    for (int32_t k = 0; k < patch->points; k++)
        outline.emplace_back((float)patch->border[2 * k],
                             (float)patch->border[2 * k + 1]);
    const cv::Rect shown = cv::boundingRect(outline) & room;
    if (shown.width < 3 || shown.height < 3)
        return 0;
    const cv::Rect box(shown.x - 2, shown.y - 2, shown.width + 4, shown.height + 4);

    std::vector<cv::Point> polygon;
    for (const cv::Point2f &p : outline)
        polygon.emplace_back(cvRound((p.x - 0.5F - (float)box.x) * 16),
                             cvRound((p.y - 0.5F - (float)box.y) * 16));
    cv::Mat mask = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{polygon}, cv::Scalar(255), 8,
                 4);
    const cv::Rect inside(2, 2, shown.width, shown.height);
    cv::Mat cut = cv::Mat::zeros(box.size(), CV_8UC1);
    mask(inside).copyTo(cut(inside));

    /* OpenCV's pixel centres are whole numbers, ours halves */
    const double *m = patch->map;
    const cv::Matx23d map(m[0], m[2], m[4] + 0.5 * (m[0] + m[2]) - 0.5 - box.x, /**/
                          m[1], m[3], m[5] + 0.5 * (m[1] + m[3]) - 0.5 - box.y);
    cv::Mat warped;
    cv::warpAffine(photo, warped, map, box.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);

    /* seamlessClone lays the middle of the mask's box onto the point it is given */
    const cv::Rect of_mask = cv::boundingRect(cut);
    if (of_mask.width < 3 || of_mask.height < 3)
        return 0;
    const cv::Point middle(box.x + of_mask.x + of_mask.width / 2,
                           box.y + of_mask.y + of_mask.height / 2);
    /* in place: otherwise it copies the whole canvas for each patch */
    cv::seamlessClone(warped, canvas, cut, middle, canvas, cv::NORMAL_CLONE);
    return 0;
}

} // namespace

extern "C" {
__attribute__((visibility("default"))) extern const tz_clone_api tz_clone_api_1;
const tz_clone_api tz_clone_api_1 = {
    [](const tz_clone_patch *patch, const tz_clone_picture *canvas, char *why, size_t n) {
        return guard(why, n, [&] {
            cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
            return paste(patch, canvas);
        });
    },
};
}
