// SPDX-License-Identifier: BSD-3-Clause
// From the JSON of Foxglove's schemas to typed arrays.

/** Bytes of a base64 string. */
export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) {
    bytes[i] = text.charCodeAt(i);
  }
  return bytes;
}

/** x, y, z of each point of a foxglove.PointCloud whose first three fields are floats x, y, z. */
export function pointsOf(cloud) {
  const bytes = bytesOf(cloud.data);
  const packed = new Float32Array(bytes.buffer, 0, bytes.length >> 2);
  const stride = cloud.point_stride / 4;
  if (stride === 3) {
    return packed;
  }
  const points = new Float32Array(3 * Math.floor(packed.length / stride));
  for (let i = 0, from = 0; i < points.length; i += 3, from += stride) {
    points[i] = packed[from];
    points[i + 1] = packed[from + 1];
    points[i + 2] = packed[from + 2];
  }
  return points;
}

/** Ends of the beams of a foxglove.LaserScan in its own plane; omits beams without a reading. */
export function beamEndsOf(scan) {
  const step = (scan.end_angle - scan.start_angle) / Math.max(scan.ranges.length - 1, 1);
  const ends = [];
  scan.ranges.forEach((range, beam) => {
    if (range > 0) {
      const angle = scan.start_angle + step * beam;
      ends.push(range * Math.cos(angle), range * Math.sin(angle), 0);
    }
  });
  return new Float32Array(ends);
}
