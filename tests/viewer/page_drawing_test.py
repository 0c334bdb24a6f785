#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the page draws: voxels, points, colours, labels, level of detail.

Environment: NODMAP_VIEWER, NODMAP_MAKE_ROBOT_LOG (programs).
"""
import base64
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from page_case import COUNT_DRAWN, PIXELS, PageCase, main  # noqa: E402

# How the number of points settles on a machine whose image takes `ms(points)`: finally [points drawn, ms per image], then how many more images a
# still scene gets, and the number of points in the last of them.
SETTLE = """
return import("/detail.js").then(({Detail}) => {
  const detail = new Detail(20000);
  const ms = (points) => 5 + points / arguments[0];
  const total = 1e6;
  let now = 0;
  for (let i = 0; i < 400; ++i) {
    detail.step(now, true, total);
    now += ms(Math.min(detail.budget, total));
  }
  const moving = Math.min(detail.budget, total);
  let refined = 0;
  for (let i = 0; i < 100; ++i) {
    now += 17;
    refined += detail.step(now, false, total);
  }
  return [moving, ms(moving), refined, Math.min(detail.budget, total)];
});
"""


def voxel_grid(columns, rows, cells, edge_m=0.1):
    """A foxglove.VoxelGrid; `cells` as bytes, x fastest."""
    return {"timestamp": {"sec": 1, "nsec": 0}, "frame_id": "map_6d",
            "pose": {"position": {"x": 1.0, "y": -0.5, "z": 0.0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "row_count": rows, "column_count": columns, "cell_size": {"x": edge_m, "y": edge_m, "z": edge_m},
            "slice_stride": rows * columns, "row_stride": columns, "cell_stride": 1,
            "fields": [{"name": "occupied", "offset": 0, "type": 1}], "data": base64.b64encode(bytes(cells)).decode()}


class Voxels(PageCase):
    def be_alone(self, browser):
        """From now on only messages made by the test arrive."""
        self.pause(browser)
        browser.run("nodmap.connection.handlers.message = () => {}")

    def show(self, browser, grid):
        """[(x, y, z) of the voxel's centre, face] of each face that is drawn, and the size of a voxel."""
        browser.run("nodmap.layers.get('OCTOMAP').layer.clear(); nodmap.take('OCTOMAP', arguments[0], 1)", grid)
        mesh = "nodmap.layers.get('OCTOMAP').layer.group.children[0]"
        self.assertIsNotNone(browser.wait_for(mesh))
        free, edge, corners = browser.run(f"""const {{geometry, userData}} = {mesh};
            return [userData.free, userData.edgeM, [...geometry.attributes.position.array]]""")
        # Each face is two triangles. No corner is farther from the centre than half the cube's diagonal, and all are in the face.
        self.assertEqual(len(corners), len(free) * 6 * 3)
        for i, (x, y, z, face) in enumerate(free):
            axis, sign = [(2, 1), (0, 1), (0, -1), (1, 1), (1, -1)][face]
            for k in range(6 * i, 6 * i + 6):
                offset = [corners[3 * k + n] - (x, y, z)[n] for n in range(3)]
                self.assertAlmostEqual(offset[axis], 0.5 * sign * edge, places=5)  # floats
                self.assertTrue(all(abs(abs(o) - 0.5 * edge) < 1e-5 for o in offset))
        return [((x, y, z), face) for x, y, z, face in free], edge

    def test_occupied_voxels_are_cubes_at_their_places(self):
        browser = self.browse(self.play())
        self.be_alone(browser)
        # Hidden at first: nothing is drawn while hidden, and then the newest map.
        browser.run("nodmap.take('OCTOMAP', arguments[0], 1)", voxel_grid(2, 2, [1] * 8))
        self.assertIsNone(browser.wait_for("nodmap.layers.get('OCTOMAP').layer.group.children.length > 0", 1))
        browser.run("document.querySelector('[data-topic=OCTOMAP]').click()")
        self.assertIsNotNone(browser.wait_for("nodmap.layers.get('OCTOMAP').layer.group.children[0]?.userData.free.length === 20"))
        # 3 columns, 2 rows, 2 slices; occupied are (0, 0, 0), (2, 1, 0) and (1, 0, 1).
        grid = voxel_grid(3, 2, [1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0], 0.5)
        grid["pose"]["position"]["x"] += browser.run("return nodmap.view.robot.x")  # where the camera looks
        faces, edge = self.show(browser, grid)
        places = [(0.25, 0.25, 0.25), (1.25, 0.75, 0.25), (0.75, 0.25, 0.75)]  # exact in binary
        # The voxels touch at edges only, so each shows all its faces but the lower one.
        self.assertEqual(faces, [(place, face) for place in places for face in range(5)])
        self.assertEqual(edge, 0.5)
        self.show_only(browser)
        self.assertEqual(browser.run(COUNT_DRAWN), 0)
        self.show_only(browser, "OCTOMAP")
        # Three cubes of half a metre, a few metres away.
        self.assertGreater(browser.run(COUNT_DRAWN), 500)
        self.assert_quiet(browser)

    def test_faces_between_voxels_are_left_out(self):
        browser = self.browse(self.play())
        self.be_alone(browser)
        browser.run("document.querySelector('[data-topic=OCTOMAP]').click()")
        # Two side by side along x: the front of the first touches the back of the second.
        faces, _ = self.show(browser, voxel_grid(2, 1, [1, 1], 0.5))
        first, second = (0.25, 0.25, 0.25), (0.75, 0.25, 0.25)
        self.assertEqual(set(faces), {(first, face) for face in (0, 2, 3, 4)} | {(second, face) for face in (0, 1, 3, 4)})

    def test_too_many_voxels_are_drawn_coarser(self):
        browser = self.browse(self.play())
        self.be_alone(browser)
        browser.run("document.querySelector('[data-topic=OCTOMAP]').click()")
        faces, edge = self.show(browser, voxel_grid(101, 100, [1] * (101 * 100 * 6)))
        # Top and sides of this block are 101 * 100 + 2 * (101 + 100) * 6 = 12512 faces, more than 12000; with cells of double size it is 51 x 50
        # x 3.
        self.assertEqual(len(faces), 51 * 50 + 2 * (51 + 50) * 3)
        self.assertAlmostEqual(edge, 0.2)
        self.assertAlmostEqual(faces[0][0][0], 0.1, places=6)  # floats

    def test_a_map_without_occupied_voxels_draws_no_cube(self):
        browser = self.browse(self.play())
        self.be_alone(browser)
        browser.run("document.querySelector('[data-topic=OCTOMAP]').click()")
        self.assertEqual(self.show(browser, voxel_grid(2, 2, [0] * 8))[0], [])
        self.assert_quiet(browser)

    def test_voxels_do_not_hide_the_robot(self):
        browser = self.browse(self.play())
        self.pause(browser)
        browser.run("nodmap.connection.handlers.message = () => {}; document.querySelector('[data-topic=OCTOMAP]').click()")
        # A block of voxels around the robot and the camera's line of sight.
        grid = voxel_grid(30, 30, [1] * (30 * 30 * 12))
        at = browser.run("return nodmap.view.robot.toArray()")
        grid["pose"]["position"] = {"x": at[0] - 1.5, "y": at[1] - 1.5, "z": 0}
        browser.run("nodmap.layers.get('OCTOMAP').layer.clear(); nodmap.take('OCTOMAP', arguments[0], 1)", grid)
        self.assertIsNotNone(browser.wait_for("nodmap.layers.get('OCTOMAP').layer.group.children.length > 0"))
        self.show_only(browser, "OCTOMAP")
        browser.run(PIXELS + "window.kept = pixels();")
        self.show_only(browser, "OCTOMAP", "scene/robot")
        self.assertGreater(browser.run(PIXELS + "return pixels().reduce((count, pixel, i) => count + (pixel !== window.kept[i]), 0);"), 500)


class Labels(PageCase):
    def test_labels_have_the_same_size_from_afar(self):
        browser = self.browse(self.play())
        self.pause(browser)
        self.show_only(browser)
        height = """
            return Promise.all([import("/drawings.js"), import("/three/build/three.module.js")]).then(([{drawEntity}, {Box3, Vector3}]) => {
              const {view} = nodmap;
              const entity = {cubes: [], cylinders: [], lines: [], texts: [{text: "label", color: {r: 1, g: 1, b: 1, a: 1},
                pose: {position: {x: view.robot.x, y: view.robot.y, z: 0.5}, orientation: {x: 0, y: 0, z: 0, w: 1}}}]};
              const [sprite] = drawEntity(entity);
              const rows = (pixels, width) => new Set(pixels.flatMap((pixel, i) => (pixel ? [Math.floor(i / width)] : []))).size;
              view.camera.position.copy(view.robot).add(new Vector3(-arguments[0], 0, 1));
              view.controls.target.copy(view.robot);
              view.controls.update();
              const image = () => {
                view.renderer.render(view.scene, view.camera);
                const gl = view.renderer.getContext();
                const bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
                gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
                return [new Uint32Array(bytes.buffer), gl.drawingBufferWidth];
              };
              const [bare] = image();
              view.scene.add(sprite);
              const [labelled, width] = image();
              view.scene.remove(sprite);
              return rows([...labelled].map((pixel, i) => pixel !== bare[i]), width);
            })"""
        near, far = browser.run(height, 3), browser.run(height, 15)
        self.assertGreater(near, 10)
        self.assertAlmostEqual(near, far, delta=2)  # whole pixels


class Clouds(PageCase):
    def test_a_new_map_replaces_the_former_one(self):
        browser = self.browse(self.play())
        begin = """return import("/cloud.js").then(({Cloud}) => {
          const cloud = new Cloud(false);
          const time = (sec) => ({sec, nsec: 0});
          const pose = {position: {x: 0, y: 0, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}};
          const add = (sec) => cloud.add({timestamp: time(sec), pose, point_stride: 12, data: btoa("\\0".repeat(12))});
          const move = (...secs) => cloud.move({times: secs.map(time), poses: secs.map(() => pose)});
          add(10);
          move(10, 11);
          add(11);
          move(11, 12);  // the server keeps a limited number of poses
          add(20);       // its pose may come later
        """
        shown = "return [[...cloud.keyframes.values()].map(({timeS}) => timeS), cloud.total]; })"
        self.assertEqual(browser.run(begin + shown), [[10, 11, 20], 3])
        self.assertEqual(browser.run(begin + "move(20);" + shown), [[20], 1])
        # The map has begun again with other keyframes.
        self.assertEqual(browser.run(begin + "move(10, 12);" + shown), [[10, 20], 2])
        # It has begun again with the first of the same keyframes.
        self.assertEqual(browser.run(begin + "add(12); move(11);" + shown), [[10, 11, 20], 3])

    def test_keyframes_of_a_former_map_that_wait_are_not_shown(self):
        """A page that is not visible draws nothing, but receives. 6D SLAM is started again meanwhile."""
        browser = self.browse(self.play())
        self.pause(browser)
        browser.run("""
          const time = (sec) => ({sec, nsec: 0});
          const pose = {position: {x: 0, y: 0, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}};
          const cloud = (sec) => nodmap.take("CLOUD", {timestamp: time(sec), frame_id: "map_6d", pose, point_stride: 12, data: btoa("\\0".repeat(12))}, sec);
          const poses = (...secs) => nodmap.take("keyframes", {timestamp: time(secs.at(-1)), frame_id: "map_6d", times: secs.map(time), poses: secs.map(() => pose)}, secs.at(-1));
          nodmap.cloud.clear();
          poses(1);
          cloud(1);
          poses(1, 2);
          cloud(2);
          cloud(101);  // may arrive before its pose
          poses(101, 102);
          cloud(102);
          cloud(103);""")
        self.assertIsNotNone(browser.wait_for("nodmap.cloud.keyframes.has('103.0')"))
        self.assertEqual(browser.run("return [...nodmap.cloud.keyframes.values()].map(({timeS}) => timeS)"), [101, 102, 103])


class Look(PageCase):
    def choose(self, browser, name, value):
        browser.run("const s = document.getElementById(arguments[0]); s.value = arguments[1]; s.dispatchEvent(new Event('change'))", name, value)
        self.settle(browser)

    def test_colours_by_height_and_by_age(self):
        browser = self.browse(self.play())
        self.pause(browser)
        self.show_only(browser, "CLOUD")
        # The image is kept in the page and compared with the next one.
        keep = PIXELS + "window.kept = pixels();"
        changed = PIXELS + "return pixels().reduce((count, pixel, i) => count + (pixel !== window.kept[i]), 0);"
        browser.run(keep)
        self.assertEqual(browser.run(changed), 0)
        self.choose(browser, "color", "age")
        self.assertGreater(browser.run(changed), 2000)
        self.assertEqual(browser.run("return document.getElementById('legend').innerText.split('\\n').map((t) => t.trim()).join(' ')"), "oldest newest")
        self.choose(browser, "color", "height")
        self.assertEqual(browser.run(changed), 0)
        self.assert_quiet(browser)

    def test_points_above_the_ceiling_height_are_not_drawn(self):
        browser = self.browse(self.play())
        self.pause(browser)
        self.show_only(browser, "CLOUD")
        drawn = []
        for ceiling in ("1", "2", "1e9"):
            self.choose(browser, "ceiling", ceiling)
            drawn.append(browser.run(COUNT_DRAWN))
        self.assertEqual(drawn, sorted(drawn))
        self.assertLess(drawn[0], 0.9 * drawn[2])  # the walls of the recording are 2.2 m high


class LevelOfDetail(PageCase):
    def test_the_number_of_points_settles_and_a_still_image_is_refined(self):
        browser = self.browse(self.play())
        # Points per millisecond: a slow machine draws few, at 20 images a second or more; a fast one draws all.
        for points_per_ms, all_of_them in ((2000, False), (10000, False), (100000, True)):
            moving, ms, refined, still = browser.run(SETTLE, points_per_ms)
            self.assertLess(ms, 50)
            self.assertEqual(moving == 1e6, all_of_them)
            self.assertEqual(still, 1e6)
            # Then nothing more is drawn: a page that does not change costs nothing.
            self.assertLess(refined, 10)


class Splats(PageCase):
    def splat(self, browser, points, ceiling_m=2, newness=None):
        """{pixel: (distance in steps of 1 cm, colour)} of an image of 10 x 10 pixels, 90 degrees wide; the camera looks along x, and y is to the right."""
        return {int(at): (value >> 8, value & 255) for at, value in browser.run("""
            return import("/splat.js").then(({splat}) => {
              const pixels = new Uint32Array(100).fill(0xffffffff);
              const m = [0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0];
              splat(new Float32Array(arguments[0].flat()), arguments[0].length, m, [0, 0, 1, 0], {
                pixels, width: 10, height: 10, unit: 100, ceilingM: arguments[1], newness: arguments[2]});
              return Object.entries(pixels).filter(([, value]) => value !== 0xffffffff);
            });""", points, ceiling_m, newness)}

    def test_points_are_drawn_in_their_places(self):
        browser = self.browse(self.play())
        # 8 m ahead, 4 m to the right, 1 m up: half and an eighth of the way from the middle, which is at pixel 5; halfway up the colours.
        self.assertEqual(self.splat(browser, [[8, 4, 1]]), {57: (800, 127)})
        self.assertEqual(self.splat(browser, [[8, 4, 1], [16, 8, 2]]), {57: (800, 127)})  # behind the first one
        self.assertEqual(self.splat(browser, [[16, 8, 2], [8, 4, 1]]), {57: (800, 127)})
        self.assertEqual(self.splat(browser, [[-8, 4, 1], [8, 9, 1], [8, 4, 1.01]], 1), {})  # behind the camera, beside the image, above the ceiling height
        self.assertEqual(self.splat(browser, [[8, 4, 1]], 2, 1), {57: (800, 255)})  # the newest
        # Near the camera a point covers four pixels.
        self.assertEqual(set(self.splat(browser, [[2, 0, 0]])), {55, 56, 65, 66})

    def test_webgl_draws_the_same_points(self):
        browser = self.browse(self.play())
        self.pause(browser)
        self.show_only(browser, "CLOUD")
        both, by_webgl, by_splats = browser.run(PIXELS + """
          const quad = nodmap.cloud.group.children.find((child) => child.isMesh);
          const shown = (splats, points) => {
            quad.visible = splats;
            nodmap.cloud.keyframes.forEach((object) => { object.visible = points; });
            return pixels();
          };
          const [none, webgl, splats] = [shown(false, false), shown(false, true), shown(true, false)];
          const count = (drawn) => none.reduce((sum, pixel, i) => sum + drawn(pixel, i), 0);
          return [count((pixel, i) => webgl[i] !== pixel && splats[i] !== pixel), count((pixel, i) => webgl[i] !== pixel),
                  count((pixel, i) => splats[i] !== pixel)];
        """)
        # Points are only roughly equal in size: 1.5 to 5 pixels, and blocks of 2 or 4 pixels.
        self.assertGreater(by_webgl, 2000)
        self.assertGreater(both, 0.6 * by_webgl)
        self.assertGreater(both, 0.4 * by_splats)


if __name__ == "__main__":
    main()
