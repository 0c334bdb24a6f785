// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/site.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace nodmap::viewer {
namespace site_test {

TEST(Site, ServesThePageAndItsFiles) {
  const Site site;
  ASSERT_NE(site.find("/"), nullptr);
  EXPECT_EQ(site.find("/")->content_type, "text/html; charset=utf-8");
  EXPECT_NE(site.find("/")->content.find("<!DOCTYPE html>"), std::string::npos);
  EXPECT_EQ(site.find("/?token=x"), site.find("/"));
  EXPECT_NE(site.find("/main.js"), nullptr);
  EXPECT_NE(site.find("/three/build/three.module.js"), nullptr);
}

TEST(Site, FindsNoOtherPath) {
  const Site site;
  for (const char* target :
       {"", "main.js", "/../../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd",
        "/three/../main.js", "/three/", "/main.js/", "/MAIN.JS", "http://127.0.0.1/main.js"}) {
    EXPECT_EQ(site.find(target), nullptr) << target;
  }
}

TEST(Site, AMissingPackageIsNamed) {
  try {
    const Site site("/nonexistent");
    FAIL() << "a site without its packages was made";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("libjs-three"), std::string::npos) << error.what();
  }
}

}  // namespace site_test
}  // namespace nodmap::viewer
