/* SPDX-License-Identifier: Apache-2.0 */
/* The structured-forest module: OpenCV's detector, and a check of the model before it,
 * because the detector believes every index that the file holds. */
#include "analysis/forest_module.h"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/ximgproc.hpp>

#include <cstdio>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

struct bad_model : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void need(bool fact, const char *what)
{
    if (!fact)
        throw bad_model(what);
}

int option(const cv::FileNode &options, const char *name, int lo, int hi)
{
    const cv::FileNode node = options[name];
    need(!node.empty() && node.isInt(),
         (std::string("option ") + name + " is missing").c_str());
    const int v = (int)node;
    need(v >= lo && v <= hi,
         (std::string("option ") + name + " is out of range").c_str());
    return v;
}

/* Rows of one length each, put one after another. */
template <class T>
std::vector<T> table(const cv::FileStorage &file, const char *name, size_t rows,
                     size_t &columns)
{
    const cv::FileNode node = file[name];
    std::vector<T> all;
    need(node.isSeq() && node.size() == rows,
         (std::string(name) + " has another number of "
                              "trees")
             .c_str());
    for (const cv::FileNode &row : node) {
        std::vector<T> one;
        row >> one;
        need(!one.empty() && (!columns || one.size() == columns),
             (std::string(name) + " has rows of different lengths").c_str());
        columns = one.size();
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

void check(const char *path)
{
    cv::FileStorage file(path, cv::FileStorage::READ);
    need(file.isOpened(), "cannot be opened");
    const cv::FileNode o = file["options"];
    need(o.isMap(), "no options");
    const int trees = option(o, "numberOfTrees", 1, 64);
    const int evaluated = option(o, "numberOfTreesToEvaluate", 1, trees);
    const int grid = option(o, "selfsimilarityGridSize", 2, 16);
    const int stride = option(o, "stride", 1, 32);
    const int shrink = option(o, "shrinkNumber", 1, 8);
    const int patch = option(o, "patchSize", 8, 128);
    const int inner = option(o, "patchInnerSize", 4, patch);
    const int bins = option(o, "numberOfGradientOrientations", 1, 16);
    option(o, "gradientSmoothingRadius", 0, 64);
    option(o, "regFeatureSmoothingRadius", 0, 64);
    option(o, "ssFeatureSmoothingRadius", 0, 64);
    option(o, "gradientNormalizationRadius", 0, 64);
    need(evaluated > 0 && stride % shrink == 0 && patch % shrink == 0 && inner % 2 == 0,
         "sizes do not divide");

    const int side = patch / shrink, channels = 3 + 2 * (1 + bins);
    const int64_t features = (int64_t)channels * side * side +
                             (int64_t)channels * (grid * grid) * (grid * grid - 1) / 2;
    size_t nodes = 0, one_bound = 0;
    const auto childs = table<int>(file, "childs", (size_t)trees, nodes);
    const auto ids = table<int>(file, "featureIds", (size_t)trees, nodes);
    const auto thresholds = table<float>(file, "thresholds", (size_t)trees, nodes);
    for (size_t i = 0; i < childs.size(); i++) {
        const int at = (int)(i % nodes);
        /* children stand after their parents, so that every walk ends */
        need(childs[i] == 0 || (childs[i] - 1 > at && (size_t)childs[i] < nodes),
             "a child is out of range");
        need(childs[i] == 0 || (ids[i] >= 0 && ids[i] < features),
             "a feature is out of range");
    }
    std::vector<int> bounds, edges;
    file["edgeBoundaries"] >> bounds;
    file["edgeBins"] >> edges;
    need(bounds.size() > 1 && (bounds.size() - 1) % childs.size() == 0,
         "edgeBoundaries has another length");
    one_bound = (bounds.size() - 1) / childs.size();
    need(one_bound >= 1, "edgeBoundaries is too short");
    for (size_t i = 0; i < bounds.size(); i++)
        need(bounds[i] >= 0 && (size_t)bounds[i] <= edges.size() &&
                 (i == 0 || bounds[i] >= bounds[i - 1]),
             "edgeBoundaries does not rise");
    for (int v : edges)
        need(v >= 0 && v < inner * inner, "edgeBins is out of range");
}

tz_forest_result fail(tz_forest_result r, std::string text, char *why, size_t size)
{
    std::snprintf(why, size, "%s", text.substr(0, text.find('\n')).c_str());
    return r;
}

} // namespace

tz_forest_result tz_forest_detect(const char *model, float *rgb, int32_t width,
                                  int32_t height, float *response, float *orientation,
                                  char *why, size_t size)
{
    try {
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
        try {
            check(model);
        } catch (const cv::Exception &e) {
            return fail(TZ_FOREST_BAD_MODEL, e.err, why, size);
        }
        const cv::Mat photo(height, width, CV_32FC3, rgb);
        cv::Mat r(height, width, CV_32F, response), o(height, width, CV_32F, orientation);
        cv::Mat edges, angles;
        auto forest = cv::ximgproc::createStructuredEdgeDetection(model);
        forest->detectEdges(photo, edges);
        forest->computeOrientation(edges, angles);
        edges.copyTo(r);
        angles.copyTo(o);
        return TZ_FOREST_OK;
    } catch (const std::bad_alloc &) {
        return fail(TZ_FOREST_NOMEM, "out of memory", why, size);
    } catch (const bad_model &e) {
        return fail(TZ_FOREST_BAD_MODEL, e.what(), why, size);
    } catch (const std::exception &e) {
        return fail(TZ_FOREST_FAILED, e.what(), why, size);
    } catch (...) {
        return fail(TZ_FOREST_FAILED, "unknown exception", why, size);
    }
}
