/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Runs a command RUNS times (its output thrown away) and measures it.
 *
 *   bench_run RUNS COMMAND [ARGUMENT...]
 *
 * prints a line: WALL CPU PEAK_MIB, medians of the times and the largest of the peaks, or
 * exits with the command's status (127 = it cannot be started). */
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/bench.h"

enum { RUNS_MAX = 99 };

int main(int argc, char **argv)
{
    double wall[RUNS_MAX], cpu[RUNS_MAX], peak = 0;
    int runs = argc > 1 ? atoi(argv[1]) : 0;
    if (argc < 3 || runs < 1) {
        fprintf(stderr, "use: bench_run RUNS COMMAND [ARGUMENT...]\n");
        return 2;
    }
    runs = runs > RUNS_MAX ? RUNS_MAX : runs;
    for (int k = 0; k < runs; k++) {
        const double start = bench_now();
        const pid_t child = fork();
        if (child == 0) {
            const int null = open("/dev/null", O_WRONLY);
            dup2(null, 1);
            dup2(null, 2);
            execvp(argv[2], argv + 2);
            _exit(127);
        }
        int status = 1;
        struct rusage u;
        if (child < 0 || wait4(child, &status, 0, &u) < 0)
            return 1;
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
            return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
        wall[k] = bench_now() - start;
        cpu[k] = (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
                 1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
        peak = (double)u.ru_maxrss / 1024 > peak ? (double)u.ru_maxrss / 1024 : peak;
    }
    printf("%.3f %.3f %.0f\n", bench_median(wall, runs), bench_median(cpu, runs), peak);
    return 0;
}
