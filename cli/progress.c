/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

void tz_bar_init(tz_bar *b, bool quiet)
{
    pthread_mutex_init(&b->lock, NULL);
    b->on = !quiet && isatty(STDERR_FILENO);
    b->shown = false;
}

static int columns(void)
{
    struct winsize w;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &w) == 0 && w.ws_col > 0 ? w.ws_col : 80;
}

/* 12345678 -> "12.3 M" */
static void scaled(double v, char text[32])
{
    static const char *const prefix[] = {"", "k", "M", "G", "T"};
    int k = 0;
    for (; v >= 1000 && k < 4; k++)
        v /= 1000;
    snprintf(text, 32, v < 10 && k ? "%.1f %s" : "%.0f %s", v, prefix[k]);
}

void tz_bar_progress(void *user, const tz_progress *p)
{
    tz_bar *b = user;
    if (!b->on)
        return;
    char tail[128] = "", rate[32], line[256];
    int width = columns(), cells = 24;
    double part = p->total > 0 ? (double)p->done / (double)p->total : 0;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    if (p->rate > 0) {
        scaled(p->rate, rate);
        int n = snprintf(tail, sizeof tail, "  %s%s/s", rate, p->unit ? p->unit : "");
        if (p->left >= 0 && n > 0)
            snprintf(tail + n, sizeof tail - (size_t)n, "  %d:%02d left",
                     (int)(p->left / 60), (int)p->left % 60);
    }
    char bar[25];
    int full = (int)(part * cells + 0.5);
    memset(bar, '.', sizeof bar - 1);
    memset(bar, '#', (size_t)full);
    bar[cells] = 0;
    snprintf(line, sizeof line, "%-10s [%s] %3d %%%s", p->stage ? p->stage : "", bar,
             (int)(100 * part), tail);
    if (width < (int)sizeof line)
        line[width > 1 ? width - 1 : 0] = 0;
    pthread_mutex_lock(&b->lock);
    fprintf(stderr, "\r%s\033[K", line);
    fflush(stderr);
    b->shown = true;
    pthread_mutex_unlock(&b->lock);
}

static void erase(tz_bar *b)
{
    if (b->shown)
        fputs("\r\033[K", stderr);
    b->shown = false;
}

void tz_bar_warning(void *user, const char *message)
{
    tz_bar *b = user;
    pthread_mutex_lock(&b->lock);
    erase(b);
    fprintf(stderr, "terrazzo: warning: %s\n", message);
    pthread_mutex_unlock(&b->lock);
}

void tz_bar_clear(tz_bar *b)
{
    pthread_mutex_lock(&b->lock);
    erase(b);
    fflush(stderr);
    pthread_mutex_unlock(&b->lock);
}
