// SPDX-License-Identifier: BSD-3-Clause
// The level of detail: how many points an image may have, so that motion stays smooth.

const FIRST_BUDGET = 200000;
const TARGET_FRAME_MS = 40;  // a little under the 50 ms that 20 images a second allow
// The frame time is the median over this many images, so that a single late image has no effect.
const IMAGES_PER_CHANGE = 8;
// An image that has not changed for this long is refined step by step until it contains all points.
const STILL_MS = 400;

export class Detail {
  /** `least`: a number of points that costs next to nothing here. */
  constructor(least) {
    this.least = least;
    this.moving = FIRST_BUDGET;  // the budget while something moves
    this.budget = FIRST_BUDGET;  // the budget of the next image
    this.frameMs = TARGET_FRAME_MS;
    this.times = [];
    this.lastMs = null;     // time of the previous image if it was drawn while something moved
    this.changedMs = -Infinity;
  }

  /** To be called before each possible image; returns whether to draw one. `changed`: it differs from the previous one. `total`: number of points. */
  step(nowMs, changed, total) {
    if (changed) {
      this.changedMs = nowMs;
      this.measure(nowMs, total);
      this.budget = this.moving;
      return true;
    }
    this.lastMs = null;  // a pause is not a slow image
    if (nowMs - this.changedMs < STILL_MS || this.budget >= total) {
      return false;
    }
    this.budget *= 2;
    return true;
  }

  measure(nowMs, total) {
    if (this.lastMs !== null) {
      this.times.push(nowMs - this.lastMs);
    }
    this.lastMs = nowMs;
    if (this.times.length < IMAGES_PER_CHANGE) {
      return;
    }
    this.frameMs = this.times.sort((a, b) => a - b)[IMAGES_PER_CHANGE / 2];
    this.times = [];
    const wanted = this.moving * Math.min(Math.max(TARGET_FRAME_MS / this.frameMs, 0.5), 1.4);
    this.moving = Math.max(this.least, Math.min(wanted, Math.max(total, FIRST_BUDGET)));
  }
}
