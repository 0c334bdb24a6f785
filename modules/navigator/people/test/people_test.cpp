// SPDX-License-Identifier: BSD-3-Clause
// Ever-free space, tracks, passive safety, and all of them together with a walker.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/people/passive_safety.hpp"
#include "modules/navigator/people/people_tracker.hpp"
#include "modules/navigator/people/proximity.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace people_test {

using test::Pillar;
using test::WalkingScene;

constexpr double kScanS = 0.01332;

time::Timestamp at(double time_s) {
  return time::Timestamp(time::from_seconds(time_s));
}

/// Covariance of positions at two times, and of a later velocity with the position at a time:
/// a walk with uncertain start and velocity and white acceleration.
double cov_pp(double t, double s) {
  const double first = std::min(t, s);
  const double last = std::max(t, s);
  return std::pow(Track::kPositionSigmaM, 2) + std::pow(Track::kVelocitySigmaMps, 2) * t * s +
         Track::kAccelerationDensity * first * first * (3.0 * last - first) / 6.0;
}
double cov_vp(double s) {
  return std::pow(Track::kVelocitySigmaMps, 2) * s + 0.5 * Track::kAccelerationDensity * s * s;
}

// The filter's state is that of all detections at once, conditioned as one Gaussian. The first
// detection is the prior's mean. Rounding only.
TEST(Track, IsTheGaussianConditionedOnAllDetections) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise_m(0.0, 0.1);
  const std::vector<double> times_s{0.0, 0.013, 0.027, 0.3, 0.313, 0.6, 0.62, 1.1};
  std::vector<double> z;
  for (const double t : times_s) {
    z.push_back(2.0 - 1.1 * t + noise_m(random));
  }
  Track track(time::Timestamp{}, {{z[0], 0.0}, 0.25, 0, 0});
  for (std::size_t i = 1; i < z.size(); ++i) {
    track.predict(at(times_s[i]));
    track.update({{z[i], 0.0}, 0.25, 0, 0});
  }
  const auto n = static_cast<Eigen::Index>(z.size()) - 1;
  Eigen::MatrixXd S(n, n);
  Eigen::VectorXd innovation(n);
  Eigen::RowVectorXd p(n);
  Eigen::RowVectorXd v(n);
  const double t_end = times_s.back();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = times_s[static_cast<std::size_t>(i) + 1];
    innovation[i] = z[static_cast<std::size_t>(i) + 1] - z[0];
    p[i] = cov_pp(t_end, t);
    v[i] = cov_vp(t);
    for (Eigen::Index j = 0; j < n; ++j) {
      S(i, j) = cov_pp(t, times_s[static_cast<std::size_t>(j) + 1]) +
                (i == j ? std::pow(Track::kPositionSigmaM, 2) : 0.0);
    }
  }
  const Eigen::VectorXd weights = S.ldlt().solve(innovation);
  EXPECT_NEAR(track.person().position.x(), z[0] + p.dot(weights), 1e-9);
  EXPECT_NEAR(track.person().velocity.x(), v.dot(weights), 1e-9);
  const double variance = cov_pp(t_end, t_end) - p.dot(S.ldlt().solve(p.transpose()));
  EXPECT_NEAR(track.person().position_sigma_m, std::sqrt(variance), 1e-9);
}

TEST(Track, BetweenSightingsTheErrorGrows) {
  Track track(time::Timestamp{}, {{1.0, 0.0}, 0.25, 0, 0});
  double last_m = 0.0;
  for (double t = 0.0; t < 1.0; t += 0.1) {
    track.predict(at(t));
    EXPECT_GT(track.person().position_sigma_m, last_m);
    last_m = track.person().position_sigma_m;
  }
}

// A board at one height, which a line has met first here and then there, is nobody, however well
// its places fit a motion; somebody who walks the same way is.
TEST(Track, WhatIsMeasuredAtOneHeightIsNobody) {
  for (const double height_m : {0.04, 0.3}) {
    Track track(time::Timestamp{}, {{2.0, 0.0}, 0.25, 0, 5, 0.44, 0.44});
    for (int i = 1; i < 60; ++i) {
      const double time_s = kScanS * i;
      track.predict(at(time_s));
      const double low_m = 0.44 - height_m * (i % 6) / 5.0;
      track.update({{2.0 - 1.0 * time_s, 0.0}, 0.25, 0, 5, low_m, low_m});
      if (i == 8) {
        EXPECT_EQ(track.is_new(), height_m > 0.1);
      }
    }
    EXPECT_EQ(track.moves(), height_m > 0.1);
  }
}

/// Nods at a scene in which pillars move, for so long; calls `check(time_s)` after each scan.
template <class Check>
void look(PeopleTracker& tracker, WalkingScene scene, const std::vector<Eigen::Vector2d>& velocity,
          double duration_s, const Check& check) {
  const std::vector<Pillar> start = scene.pillars;
  for (double time_s = 0.0; time_s < duration_s; time_s += kScanS) {
    for (std::size_t i = 0; i < start.size(); ++i) {
      scene.pillars[i].center = start[i].center + time_s * velocity[i];
    }
    tracker.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {});
    check(time_s);
  }
}

// A person of 0.25 m radius; the disc seen of him is up to half a beam wider. Measured: 0.11 m,
// 0.32 m/s after the first second.
TEST(PeopleTracker, FollowsAWalkerFromSweepToSweep) {
  for (const Eigen::Vector2d& velocity :
       {Eigen::Vector2d(-1.2, 0.1), Eigen::Vector2d(0.0, 1.0), Eigen::Vector2d(-0.4, -0.5)}) {
    // The space must have been seen free before somebody comes.
    PeopleTracker tracker;
    const Eigen::Vector2d start = Eigen::Vector2d(2.2, 0.0) - 4.0 * velocity;
    double seen_s = 0.0;
    double known_s = 0.0;
    look(tracker, {{{start, 0.25, 1.7}}, 8.0}, {velocity}, 4.5, [&](double time_s) {
      const Eigen::Vector2d p = start + time_s * velocity;
      if (time_s < 3.3) {
        return;
      }
      seen_s += kScanS;
      const People people = tracker.people_odom(at(time_s));
      if (people.size() == 1) {
        known_s += kScanS;
        EXPECT_LT((people[0].position - p).norm(), 0.25) << time_s;
        EXPECT_LT((people[0].velocity - velocity).norm(), 0.5) << time_s;
      }
    });
    EXPECT_GT(known_s, 0.9 * seen_s) << velocity.transpose();
  }
}

// A cylinder 1 m wide, which comes and passes by. Of its front the mean of beams lies pi/4 of half
// the visible width before the centre only where all of it is seen: 0.2 m.
TEST(PeopleTracker, FollowsWhatIsWiderThanAPerson) {
  const Eigen::Vector2d velocity(-1.0, 0.3);
  const Eigen::Vector2d start = Eigen::Vector2d(2.2, 0.0) - 4.0 * velocity;
  double known_s = 0.0;
  PeopleTracker tracker;
  look(tracker, {{{start, 0.5, 1.7}}, 8.0}, {velocity}, 4.5, [&](double time_s) {
    const People people = tracker.people_odom(at(time_s));
    if (time_s > 3.3 && people.size() == 1) {
      known_s += kScanS;
      EXPECT_LT((people[0].position - start - time_s * velocity).norm(), 0.25) << time_s;
      EXPECT_LT((people[0].velocity - velocity).norm(), 0.5) << time_s;
      EXPECT_NEAR(people[0].radius_m, 0.5, 0.08) << time_s;
    }
  });
  EXPECT_GT(known_s, 0.9 * 1.2);
}

/// Scans 40 times a second with a laser that is held level, of pillars that move.
template <class Check>
void look_level(PeopleTracker& tracker, WalkingScene scene,
                const std::vector<Eigen::Vector2d>& velocity, double duration_s,
                const Check& check) {
  const std::vector<Pillar> start = scene.pillars;
  for (double time_s = 0.0; time_s < duration_s; time_s += 0.025) {
    for (std::size_t i = 0; i < start.size(); ++i) {
      scene.pillars[i].center = start[i].center + time_s * velocity[i];
    }
    const geometry::SE2 T_odom_base{0.5 * time_s, 0.0, 0.2 * std::sin(time_s)};
    tracker.add_scan(test::level_scan(scene, at(time_s), T_odom_base), T_odom_base, {}, true);
    check(time_s);
  }
}

// It shows one height only, but that 40 times a second: who comes into view from behind a pillar,
// where no space was seen to be free, is known half a second later.
TEST(PeopleTracker, WithALevelLaserWhoComesFromBehindAPillarIsKnownSoon) {
  for (const double radius_m : {0.25, 0.5}) {
    const Eigen::Vector2d start(4.5, -1.8);
    const Eigen::Vector2d velocity(-0.3, 1.0);
    double in_view_s = -1.0;
    double known_s = -1.0;
    PeopleTracker tracker;
    look_level(tracker, {{{{3.0, -0.9}, 0.4, 1.7}, {start, radius_m, 1.7}}, 8.0},
               {Eigen::Vector2d::Zero(), velocity}, 4.0, [&](double time_s) {
                 const Eigen::Vector2d p = start + time_s * velocity;
                 const Eigen::Vector2d mount(0.15 + 0.5 * time_s, 0.0);
                 const auto bearing = [&](const Eigen::Vector2d& q) {
                   return std::atan2(q.y() - mount.y(), q.x() - mount.x());
                 };
                 const double edge_rad = bearing(p) - std::asin(radius_m / (p - mount).norm());
                 const Eigen::Vector2d post(3.0, -0.9);
                 const double post_rad = bearing(post) + std::asin(0.4 / (post - mount).norm());
                 if (in_view_s < 0.0 && edge_rad > post_rad) {
                   in_view_s = time_s;
                 }
                 const People people = tracker.people_odom(at(time_s));
                 if (in_view_s >= 0.0 && !people.empty()) {
                   known_s = known_s < 0.0 ? time_s : known_s;
                   ASSERT_EQ(people.size(), 1U);
                   EXPECT_LT((people[0].position - p).norm(), 0.2) << time_s;
                   EXPECT_NEAR(people[0].radius_m, radius_m, 0.1) << time_s;
                 }
               });
    EXPECT_GE(known_s, 0.0);
    EXPECT_LT(known_s - in_view_s, 0.5) << radius_m;
  }
}

// Pillars, one of which hides another for a while, and a wall beyond: the robot drives and turns.
TEST(PeopleTracker, WithALevelLaserWhatStandsIsNobody) {
  PeopleTracker tracker;
  look_level(tracker,
             {{{{3.0, 0.6}, 0.3, 1.7}, {{4.5, 0.8}, 0.15, 1.7}, {{3.5, -0.9}, 0.5, 1.7}}, 6.0},
             std::vector<Eigen::Vector2d>(3, Eigen::Vector2d::Zero()), 5.0, [&](double time_s) {
               EXPECT_TRUE(tracker.people_odom(at(time_s)).empty()) << time_s;
               EXPECT_TRUE(tracker.newcomers_odom(at(time_s)).empty()) << time_s;
             });
}

// Within 0.6 m of the laser the tilted plane of a scan leaves the heights of legs within a person:
// his place must not be that of the part below.
TEST(PeopleTracker, WhoIsVeryNearIsWhereAllOfHimIs) {
  const Eigen::Vector2d start(0.85, 4.0);
  const Eigen::Vector2d velocity(0.0, -1.0);
  double worst_m = 0.0;
  PeopleTracker tracker;
  look(tracker, {{{start, 0.25, 1.7}}, 6.0}, {velocity}, 4.3, [&](double time_s) {
    if (time_s < 3.4) {
      return;
    }
    for (const Person& person : tracker.people_odom(at(time_s))) {
      worst_m = std::max(worst_m, (person.position - start - time_s * velocity).norm());
    }
  });
  EXPECT_GT(worst_m, 0.0);
  EXPECT_LT(worst_m, 0.17);
}

/// What the infrared range finders see, one of them.
Proximity::Ranges only(robot::Infrared sensor, double range_m) {
  Proximity::Ranges ranges_m;
  ranges_m.fill(std::numeric_limits<double>::quiet_NaN());
  ranges_m[static_cast<std::size_t>(sensor)] = range_m;
  return ranges_m;
}

class ProximityTest : public ::testing::Test {
 protected:
  static constexpr robot::Infrared kBack = robot::Infrared::kBack;
  static constexpr robot::Infrared kRight = robot::Infrared::kRight;

  /// From the origin the floor ahead and a post are seen; then the robot stands on that floor.
  ProximityTest() {
    const WalkingScene scene{{{{1.5, -0.6}, 0.1, 1.7}}, 6.0};
    for (double time_s = 0.0; time_s < 3.0; time_s += kScanS) {
      map_.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {});
    }
  }

  [[nodiscard]] bool sees(double time_s, const Proximity::Ranges& ranges_m,
                          const People& tracked_odom = {}) {
    proximity_.add(at(time_s), ranges_m, {1.5, 0.0, 0.0}, map_, tracked_odom);
    return proximity_.is_detected(at(time_s));
  }

  LocalMap map_{{}, {}};
  Proximity proximity_;
};

TEST_F(ProximityTest, SomebodyBehindIsDetectedUntilHalfASecondAfter) {
  EXPECT_FALSE(sees(10.0, only(kBack, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(sees(11.0, only(kBack, 0.4)));
  EXPECT_TRUE(sees(11.4, only(kRight, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(proximity_.is_detected(at(11.6)));
  EXPECT_FALSE(proximity_.is_detected(at(9.0))) << "a clock that was set back";
}

TEST_F(ProximityTest, WhatTheMapHasIsNobody) {
  EXPECT_FALSE(sees(10.0, only(kRight, 0.335))) << "the post";
  EXPECT_FALSE(sees(10.1, only(kRight, 0.25))) << "by an error of the sensor";
  EXPECT_TRUE(sees(10.2, only(kRight, 0.1))) << "before it";
}

// The reading behind is 0.4 m from the body, whose rear is at 1.5 - 0.225 m.
TEST_F(ProximityTest, WhoIsTrackedIsNoStranger) {
  const Person him{{0.7, 0.0}, {0.5, 0.0}, 0.25, 0.1, 0.1};
  Person elsewhere = him;
  elsewhere.position.x() = 0.0;
  EXPECT_FALSE(sees(10.0, only(kBack, 0.4), {him}));
  EXPECT_TRUE(sees(10.1, only(kBack, 0.4), {elsewhere}));
}

TEST_F(ProximityTest, WhereNoFloorWasSeenSomethingMayStand) {
  proximity_.add(at(10.0), only(kBack, 0.4), {-2.0, 0.0, 0.0}, map_, {});
  EXPECT_FALSE(proximity_.is_detected(at(10.0)));
}

TEST_F(ProximityTest, WhatStandsIsWaitedForBriefly) {
  double time_s = 10.0;
  for (; time_s < 10.55; time_s += 0.05) {
    EXPECT_TRUE(sees(time_s, only(kBack, 0.4)));
  }
  for (; time_s < 11.2; time_s += 0.05) {
    static_cast<void>(sees(time_s, only(kBack, 0.4)));
  }
  EXPECT_FALSE(sees(time_s, only(kBack, 0.4)));
  EXPECT_TRUE(sees(time_s + 0.05, only(kBack, 0.3))) << "it comes";
}

TEST_F(ProximityTest, AnObstacleThatWasForgottenIsNobody) {
  // Odometry drifts while the robot rotates, and looks elsewhere: 8 rad count as 32 m of travel.
  for (int i = 0; i < 80; ++i) {
    const double yaw_rad = geometry::kPi + (i % 2 == 0 ? 0.05 : -0.05);
    map_.add_scan(WalkingScene{{}, 6.0}.scan(at(3.0 + i * kScanS), {0.0, 0.0, yaw_rad}, 0.0),
                  {0.0, 0.0, yaw_rad});
  }
  ASSERT_FALSE(map_.is_blocked_at(Eigen::Vector2d(1.5, -0.5))) << "the post";
  EXPECT_FALSE(sees(10.0, only(kRight, 0.335)));
}

/// There nothing but the body's place is known; the border is no exception.
TEST_F(ProximityTest, FloorThatIsAssumedWhereTheRobotWasSetDownIsNotKnownToBeFree) {
  const WalkingScene scene{{}, 6.0};
  LocalMap map{{}, {}};
  map.add_scan(scene.scan(at(0.0), {}, 0.0), {});
  ASSERT_TRUE(map.is_free_floor({-0.35, 0.0}));
  for (std::size_t sensor = 0; sensor < robot::kInfraredCount; ++sensor) {
    for (double range_m = 0.1; range_m <= 0.8; range_m += 0.005) {
      Proximity proximity;
      proximity.add(at(10.0), only(static_cast<robot::Infrared>(sensor), range_m), {}, map, {});
      EXPECT_FALSE(proximity.is_detected(at(10.0))) << sensor << ' ' << range_m;
    }
  }
}

/// A walker passes the robot and goes on behind it, where nobody looks; `check(time_s, p, people)`
/// for each scan from then on, until `duration_s` after it.
template <class Check>
void walk_out_of_view(const PeopleTracker::IsBlocked& is_blocked, double duration_s,
                      const Check& check) {
  PeopleTracker tracker;
  const Eigen::Vector2d start(6.5, 0.9);
  const Eigen::Vector2d velocity(-1.3, 0.0);
  WalkingScene scene{{{start, 0.25, 1.7}}, 8.0};
  const double seen_until_s = (start.x() + 0.25 - 0.15) / 1.3;
  for (double time_s = 0.0; time_s < seen_until_s + duration_s; time_s += kScanS) {
    scene.pillars[0].center = start + time_s * velocity;
    tracker.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {}, is_blocked);
    if (time_s > seen_until_s) {
      check(time_s - seen_until_s, scene.pillars[0].center, tracker.people_odom(at(time_s)));
    }
  }
}

// Measured: 0.5 m, 2.5 s after he was seen last.
TEST(PeopleTracker, WhoWalksOutOfViewGoesOnForTwelveSeconds) {
  walk_out_of_view({}, 13.0, [](double time_s, const Eigen::Vector2d& p, const People& people) {
    if (time_s < 2.5) {
      ASSERT_EQ(people.size(), 1U) << time_s;
      EXPECT_LT((people[0].position - p).norm(), 0.6) << time_s;
    } else if (time_s < 11.5) {
      EXPECT_EQ(people.size(), 1U) << time_s;
    } else if (time_s > 12.2) {
      EXPECT_TRUE(people.empty()) << time_s;
    }
  });
}

// A wall at x = -3, before which he turns by 0.6 m: then he is where the mirror image of his walk
// is. Twice the error of 10 cm of the wall's steps, and that of the track.
TEST(PeopleTracker, WhoIsOutOfViewTurnsRoundBeforeAWall) {
  int num_back = 0;
  walk_out_of_view([](const Eigen::Vector2d& p_odom) { return p_odom.x() < -3.0; }, 3.2,
                   [&](double time_s, const Eigen::Vector2d& p, const People& people) {
                     ASSERT_EQ(people.size(), 1U) << time_s;
                     const double x = p.x() < -2.4 ? -4.8 - p.x() : p.x();
                     EXPECT_LT((people[0].position - Eigen::Vector2d(x, p.y())).norm(), 0.8);
                     num_back += people[0].velocity.x() > 1.0 ? 1 : 0;
                   });
  EXPECT_GT(num_back, 30);
}

// What is measured within his own disc does not turn him round, nor what is on both sides of him.
TEST(PeopleTracker, WhoIsOutOfViewIsNotStoppedByHimself) {
  const auto is_on_him = [](double time_s, const Eigen::Vector2d& p_odom) {
    const double x = 0.15 - 0.25 - 1.3 * time_s;
    return (p_odom - Eigen::Vector2d(x, 0.9)).norm() < 0.3;
  };
  double now_s = -1.0;  // while he is in view: far behind him
  walk_out_of_view([&](const Eigen::Vector2d& p_odom) { return is_on_him(now_s, p_odom); }, 2.0,
                   [&](double time_s, const Eigen::Vector2d& /*p*/, const People& people) {
                     now_s = time_s;
                     ASSERT_EQ(people.size(), 1U) << time_s;
                     EXPECT_LT(people[0].velocity.x(), 0.0) << time_s;
                   });
}

// At all heights, and the floor around him is nobody.
TEST(PeopleTracker, WhatEndsOnAWalkerIsHis) {
  PeopleTracker tracker;
  WalkingScene scene{{{{5.0, -3.0}, 0.25, 1.7}}, 6.0};
  std::size_t num_low = 0;
  std::size_t num_his = 0;
  std::size_t num_found = 0;
  for (double time_s = 0.0; time_s < 4.5; time_s += kScanS) {
    scene.pillars[0].center = Eigen::Vector2d(2.0 + 0.1 * time_s, -3.0 + time_s);
    const scan::Scan scan = scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s));
    tracker.add_scan(scan, {});
    if (time_s < 3.0 || tracker.people_odom(at(time_s)).size() != 1) {
      continue;
    }
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (!scan.is_hit(i)) {
        continue;
      }
      const Eigen::Vector3d p = scan::point_in_base(scan, i, static_cast<double>(scan.ranges_m[i]));
      const bool is_his = p.z() > 0.03 && (p.head<2>() - scene.pillars[0].center).norm() < 0.26;
      num_his += is_his ? 1 : 0;
      num_found += is_his && tracker.is_walker()[i] ? 1 : 0;
      num_low += is_his && p.z() < 0.2 ? 1 : 0;
      EXPECT_TRUE(is_his || !tracker.is_walker()[i]) << p.transpose();
    }
  }
  EXPECT_GT(num_low, 100U);
  EXPECT_GT(static_cast<double>(num_found), 0.95 * static_cast<double>(num_his));
}

// A low box is passed over before it is hit, a pillar stands, and the robot turns before a wall.
TEST(PeopleTracker, WhatStandsIsNobody) {
  PeopleTracker tracker;
  WalkingScene scene{{{{2.0, 0.5}, 0.3, 0.27}, {{2.0, -0.8}, 0.15, 1.7}}, 4.0};
  for (double time_s = 0.0; time_s < 5.0; time_s += kScanS) {
    const geometry::SE2 T_odom_base{0.2 * time_s, 0.0, 0.4 * std::sin(time_s)};
    tracker.add_scan(scene.scan(at(time_s), T_odom_base, test::nodding_pitch_rad(time_s)),
                     T_odom_base);
    EXPECT_TRUE(tracker.people_odom(at(time_s)).empty()) << time_s;
  }
}

// Head on: with reaction time T and deceleration a, the robot needs T + (v - 0.05) / a, and drives
// v T + (v^2 - 0.05^2) / 2a meanwhile; the walker comes nearer by his speed. Steps of 50 ms at 2
// m/s and more: 0.15 m.
TEST(PassiveSafety, HeadOnItIsStationaryOnContact) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const double a = params.robot.braking.deceleration_mps2;
  const double T = params.drive.reaction_s;
  for (const double v : {0.3, 0.7, 1.2}) {
    for (const double walker_mps : {0.5, 1.4, 2.0}) {
      const double needed_m = v * T + (v * v - 0.0025) / (2.0 * a) +
                              walker_mps * (T + (v - 0.05) / a) + 0.5 * params.robot.body.length_m +
                              0.25 + params.people.margin_m;
      const auto is_safe = [&](double distance_m) {
        return safety.is_safe({v, 0.0}, {{{distance_m, 0.0}, {-walker_mps, 0.0}, 0.25, 0.0, 0.0}});
      };
      EXPECT_FALSE(is_safe(needed_m - 0.15)) << v << ' ' << walker_mps;
      EXPECT_TRUE(is_safe(needed_m + 0.15)) << v << ' ' << walker_mps;
    }
  }
}

TEST(PassiveSafety, StandingIsSafeAndAWalkerWhoLeavesIsNoReasonToStop) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  EXPECT_TRUE(safety.is_safe({}, {{{0.3, 0.0}, {-1.0, 0.0}, 0.25, 0.1, 0.3}}));
  EXPECT_EQ(safety.safe_factor({0.8, 0.0}, {{{1.2, 0.0}, {1.5, 0.0}, 0.25, 0.05, 0.2}}), 1.0);
  // He crosses ahead, and is gone before the robot is there.
  EXPECT_EQ(safety.safe_factor({0.5, 0.0}, {{{1.0, 0.6}, {0.0, 1.2}, 0.25, 0.05, 0.2}}), 1.0);
  // The corners of a robot that rotates beside somebody count, too.
  const double factor = safety.safe_factor({0.0, 1.0}, {{{0.0, 0.5}, {0.0, -0.8}, 0.2, 0.0, 0.0}});
  EXPECT_LT(factor * params.robot.body.footprint().turning_radius_m(), 0.05);  // stationary
}

// A rotation at w is over after T + (r w - 0.05) / a, r to the corners: by then somebody out of
// sight has walked his speed times that, in whatever direction. Steps of 50 ms at 1.5 m/s: 8 cm.
TEST(PassiveSafety, WhoIsOutOfSightMayComeBackFromWhereHeIs) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const double corner_m = params.robot.body.footprint().turning_radius_m();
  for (const double w : {0.5, 1.0}) {
    for (const double direction : {-1.0, 1.0}) {
      const double needed_m =
          0.5 * params.robot.body.length_m + 0.25 + params.people.margin_m + 0.3 +
          1.5 * (params.drive.reaction_s +
                 (corner_m * w - 0.05) / params.robot.braking.deceleration_mps2);
      const auto is_safe = [&](double distance_m, bool is_in_sight) {
        return safety.is_safe(
            {0.0, w}, {{{-distance_m, 0.0}, {1.5 * direction, 0.0}, 0.25, 0.3, 0.0, is_in_sight}});
      };
      // The corners reach farther than half the length, by the body's half diagonal at most.
      EXPECT_TRUE(is_safe(needed_m + 0.15, false)) << w;
      EXPECT_FALSE(is_safe(needed_m - 0.08, false)) << w;
      EXPECT_EQ(is_safe(needed_m - 0.15, true), direction < 0.0) << "in sight he goes on";
    }
  }
}

// He comes from the side at 1 m/s, 1.2 m away. A robot that drives at 1 m/s is out of his way when
// he is there, with 1.1 m ahead of his disc of 0.25 m; braking, it would stand in it.
TEST(PassiveSafety, ItEscapesWhoWouldWalkIntoTheStandingRobot) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const People crossing{{{0.3, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_TRUE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, crossing));
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {0.0, 0.0}, crossing)) << "that is standing";
  // With an error of 0.6 m/s he might be faster. At 1.5 m/s it is too late to be stationary: it
  // goes on where he most likely is not. At 0.3 m/s it is not.
  People uncertain = crossing;
  uncertain[0].velocity_sigma_mps = 0.6;
  ASSERT_FALSE(safety.is_safe({1.5, 0.0}, uncertain));
  EXPECT_TRUE(safety.escapes({1.5, 0.0}, {1.5, 0.0}, uncertain));
  ASSERT_TRUE(safety.is_safe({0.3, 0.0}, uncertain));
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.5, 0.0}, uncertain));
  // Standing is enough: he passes ahead.
  const People ahead{{{1.2, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.0, 0.0}, ahead));
  // Nor is there any way out between two.
  People both = crossing;
  both.push_back({{2.0, 0.0}, {-1.0, 0.0}, 0.25, 0.0, 0.0});
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, both));
}

TEST(PassiveSafety, WhereSomebodyWalksTheRobotDoesNotBackUp) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {}), 1.0);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {{{4.0, 0.0}, {0.0, 1.0}, 0.25, 0.0, 0.0}}), 0.0);
}

// Whatever is near, a slower motion is no less safe.
TEST(PassiveSafety, WhatIsSafeIsSafeMoreSlowlyHeadOn) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  double last = 0.0;
  for (double distance_m = 0.5; distance_m < 4.0; distance_m += 0.1) {
    const double factor =
        safety.safe_factor({1.0, 0.0}, {{{distance_m, 0.1}, {-1.5, 0.0}, 0.25, 0.05, 0.3}});
    EXPECT_GE(factor, last);
    last = factor;
  }
  EXPECT_EQ(last, 1.0);
}

}  // namespace people_test
}  // namespace nodmap::navigator
