// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/known_ground.hpp"

#include <gtest/gtest.h>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace known_ground_test {

using Kind = KnownGround::Kind;

// A box at `x_m` that a level laser sees, and that is gone later.
class VanishingBox {
 public:
  explicit VanishingBox(double x_m) : p_(x_m + 0.01, 0.0) {
    now_.local_map = &map_;
    now_.laser_is_held = true;
  }

  // Enough scans to make it an obstacle, or none any more.
  void look(bool is_there) {
    test::Ground ground{.blocks = {{{4.0, -3.0}, {4.2, 3.0}, 0.5}}};
    if (is_there) {
      ground.blocks.push_back({{p_.x() - 0.01, -0.2}, {p_.x() + 0.2, 0.2}, 0.5});
    }
    for (int i = 0; i < 12; ++i) {
      scan::Scan scan = test::scan_of(ground, {}, 0.0);
      scan.T_base_mount.translation().z() = 0.29;
      map_.add_scan(scan, {});
    }
  }
  Kind update() {
    ground_.update(now_);
    return ground_.at((p_ / KnownGround::kCellM).array().floor().cast<int>());
  }

 private:
  Eigen::Vector2d p_;
  LocalMap map_{{}, {}};
  Situation now_;
  KnownGround ground_;
};

// What was only seen from 2 m away may be in a wrong place, as odometry drifts.
TEST(KnownGround, AnObstacleFromAfarIsGoneAtOnce) {
  VanishingBox box(2.0);
  box.look(true);
  EXPECT_EQ(box.update(), Kind::kBlocked);
  box.look(false);
  EXPECT_EQ(box.update(), Kind::kCleared);
}

TEST(KnownGround, AnObstacleFromNearbyIsGoneWhenFourUpdatesShowThat) {
  VanishingBox box(1.0);
  box.look(true);
  EXPECT_EQ(box.update(), Kind::kBlocked);
  box.look(false);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(box.update(), Kind::kBlocked) << i;
  }
  EXPECT_EQ(box.update(), Kind::kCleared);
}

// What noise occupies again and again for a moment stays an obstacle.
TEST(KnownGround, AnObstacleThatIsSeenAgainIsNotGone) {
  VanishingBox box(1.0);
  box.look(true);
  EXPECT_EQ(box.update(), Kind::kBlocked);
  for (int i = 0; i < 3; ++i) {
    box.look(false);
    EXPECT_EQ(box.update(), Kind::kBlocked) << i;
    EXPECT_EQ(box.update(), Kind::kBlocked) << i;
    box.look(true);
    EXPECT_EQ(box.update(), Kind::kBlocked) << i;
  }
}

}  // namespace known_ground_test
}  // namespace nodmap::navigator
