/* SPDX-License-Identifier: Apache-2.0 */
/* Modules are found relative to the file that holds this code: the shared library, or the
 * program where it is linked statically. Build tree and install tree have the same shape:
 *
 *   bin/terrazzo   lib/libterrazzo.so.0   lib/terrazzo/libterrazzo_<name>.so
 *
 * No handle is kept: dlopen counts, and gives the same one again. */
#include "base/module.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void *open_in(const char *dir, const char *name, char *error, size_t size)
{
    char path[PATH_MAX + 256];
    snprintf(path, sizeof path, "%s/libterrazzo_%s.so", dir, name);
    if (access(path, F_OK) != 0)
        return NULL;
    void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (!handle) {
        const char *why = dlerror();
        snprintf(error, size, "%s", why ? why : "cannot be opened");
    }
    return handle;
}

/* Folder of the file that holds this code; false if it cannot be told. */
static bool own_folder(char self[PATH_MAX])
{
    static const char here; /* an address inside that file */
    Dl_info info;
    if (!dladdr(&here, &info) || !info.dli_fname || !realpath(info.dli_fname, self))
        return false;
    char *slash = strrchr(self, '/');
    if (slash)
        *slash = 0;
    return true;
}

tz_status tz_module_data(tz_ctx *ctx, const char *name, char **path)
{
    static const char *const places[] = {"../share/terrazzo", "../../share/terrazzo",
                                         TZ_DATA_RELATIVE};
    char self[PATH_MAX] = "", file[2 * PATH_MAX + 256];
    bool found = false;
    if (own_folder(self))
        for (size_t i = 0; i < sizeof places / sizeof *places && !found; i++) {
            snprintf(file, sizeof file, "%s/%s/%s", self, places[i], name);
            found = access(file, R_OK) == 0;
        }
    if (!found) {
        snprintf(file, sizeof file, "%s/%s", TZ_DATA_DIR, name);
        found = access(file, R_OK) == 0;
    }
    if (!found)
        return tz_fail(ctx, TZ_IO,
                       "%s: it belongs to Terrazzo but is not there; install "
                       "it in %s",
                       name, TZ_DATA_DIR);
    return tz_strdup(ctx, file, path);
}

tz_status tz_module_symbol(tz_ctx *ctx, const char *name, const char *symbol, void *out)
{
    static const char *const places[] = {"terrazzo", "../lib/terrazzo",
                                         TZ_MODULE_RELATIVE};
    char self[PATH_MAX] = "", error[512] = "it is not there";
    void *handle = NULL;
    if (own_folder(self))
        for (size_t i = 0; i < sizeof places / sizeof *places && !handle; i++) {
            char dir[PATH_MAX + 128];
            snprintf(dir, sizeof dir, "%s/%s", self, places[i]);
            handle = open_in(dir, name, error, sizeof error);
        }
    if (!handle)
        handle = open_in(TZ_MODULE_DIR, name, error, sizeof error);
    if (!handle)
        return tz_fail(
            ctx, TZ_UNSUPPORTED,
            "module libterrazzo_%s.so, needed here, cannot be used: %s; install "
            "it in %s",
            name, error, TZ_MODULE_DIR);
    void *p = dlsym(handle, symbol);
    if (!p)
        return tz_fail(ctx, TZ_UNSUPPORTED,
                       "module libterrazzo_%s.so has no %s: it is of another version; "
                       "install both of one version",
                       name, symbol);
    memcpy(out, &p, sizeof p);
    return TZ_OK;
}
