/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Several noises at once: scenes ask for some thirty a pixel. Private to
 * scenes/. */
#ifndef TZ_SCENES_NOISE_H
#define TZ_SCENES_NOISE_H

#include <stdint.h>

/** Seed of noises out of a seed of the scene's; add small numbers for others. */
uint32_t tz_noise_seed(uint64_t seed);

/** tz_canvas_fbm of two seeds at one place, up to 4 octaves each. */
void tz_noise_pair(uint32_t seed, uint32_t other, double x, double y, int octaves,
                   float gain, float out[2]);

/** Noise of a skin: its four marks, at places of their own. */
typedef struct tz_noise_skin {
    double stain_x, stain_y, streak_x, streak_y, grain_x, grain_y, speck_x, speck_y;
} tz_noise_skin;
/** @param[out] out  stain, streak, grain (sums of 3, 2, 2 octaves), speck */
void tz_noise_of_skin(uint32_t seed, const tz_noise_skin *at, float out[4]);

#endif
