# SPDX-License-Identifier: Apache-2.0
# Libraries, one list a folder. `./dev deps` installs them on Debian.
pkg_check_modules(PNG REQUIRED IMPORTED_TARGET libpng)
pkg_check_modules(JPEG REQUIRED IMPORTED_TARGET libjpeg)
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)
pkg_check_modules(DEFLATE REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(XML REQUIRED IMPORTED_TARGET libxml-2.0)
pkg_check_modules(JANSSON REQUIRED IMPORTED_TARGET jansson)
pkg_check_modules(FLANN REQUIRED IMPORTED_TARGET flann)
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)
pkg_check_modules(RSVG REQUIRED IMPORTED_TARGET librsvg-2.0 cairo)
find_package(OpenEXR REQUIRED)
find_path(CHOLMOD_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_package(OpenCV REQUIRED COMPONENTS core imgproc photo)

add_library(tz_cholmod INTERFACE)
target_include_directories(tz_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE})
target_link_libraries(tz_cholmod INTERFACE ${CHOLMOD_LIBRARY})

set(TZ_BASE_LIBRARIES PkgConfig::PNG PkgConfig::JPEG PkgConfig::ZLIB PkgConfig::DEFLATE
    PkgConfig::XML PkgConfig::FLANN OpenEXR::OpenEXRCore tz_cholmod)
set(TZ_ANALYSIS_LIBRARIES PkgConfig::JANSSON opencv_core opencv_imgproc)
set(TZ_SYNTHESIS_LIBRARIES PkgConfig::JANSSON)
set(TZ_CLI_LIBRARIES PkgConfig::JANSSON)
