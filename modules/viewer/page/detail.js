// SPDX-License-Identifier: BSD-3-Clause
// The level of detail: how many points an image may have, so that what moves keeps moving.

const FIRST_BUDGET = 200000;
const TARGET_FRAME_MS = 40;  // a little under the 50 ms that 20 images a second allow
// A change is judged by the median of so many images: one late image says nothing.
const PICTURES_PER_CHANGE = 8;
// An image that has not changed for so long is drawn finer, step by step, until every point is in it.
const STILL_MS = 400;

export class Detail {
  /** `least`: so many points cost next to nothing here. */
  constructor(least) {
    this.least = least;
    this.moving = FIRST_BUDGET;  // the budget while something moves
    this.budget = FIRST_BUDGET;  // that of the next image
    this.frameMs = TARGET_FRAME_MS;
    this.times = [];
    this.lastMs = null;     // of the image before, if it was drawn while something moved
    this.changedMs = -Infinity;
  }

  /** Before each possible image: whether to draw one. `changed`: it differs from the one before. `total`: points there are. */
  step(nowMs, changed, total) {
    if (changed) {
      this.changedMs = nowMs;
      this.measure(nowMs, total);
      this.budget = this.moving;
      return true;
    }
    this.lastMs = null;  // a pause is no slow image
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
    if (this.times.length < PICTURES_PER_CHANGE) {
      return;
    }
    this.frameMs = this.times.sort((a, b) => a - b)[PICTURES_PER_CHANGE / 2];
    this.times = [];
    const wanted = this.moving * Math.min(Math.max(TARGET_FRAME_MS / this.frameMs, 0.5), 1.4);
    this.moving = Math.max(this.least, Math.min(wanted, Math.max(total, FIRST_BUDGET)));
  }
}
