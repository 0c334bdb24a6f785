// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/file_descriptor.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

namespace nodmap::formats {
namespace file_descriptor_test {

int open_anything() {
  return ::open("/dev/null", O_RDONLY | O_CLOEXEC);
}

bool is_open(int fd) {
  return ::fcntl(fd, F_GETFD) >= 0;
}

TEST(FileDescriptor, ClosesAtTheEndOfItsScope) {
  int fd = -1;
  {
    const FileDescriptor owner(open_anything());
    fd = owner.get();
    EXPECT_TRUE(owner.is_open());
    EXPECT_TRUE(is_open(fd));
  }
  EXPECT_FALSE(is_open(fd));
}

TEST(FileDescriptor, AMoveLeavesOneOwner) {
  FileDescriptor first(open_anything());
  const int fd = first.get();
  {
    FileDescriptor second(std::move(first));
    EXPECT_EQ(second.get(), fd);
    FileDescriptor third;
    EXPECT_FALSE(third.is_open());
    third = std::move(second);
    EXPECT_EQ(third.get(), fd);
    EXPECT_TRUE(is_open(fd));
  }
  EXPECT_FALSE(is_open(fd));
}

TEST(FileDescriptor, WhatIsReleasedStaysOpen) {
  int fd = -1;
  {
    FileDescriptor owner(open_anything());
    fd = owner.release();
    EXPECT_FALSE(owner.is_open());
  }
  EXPECT_TRUE(is_open(fd));
  ::close(fd);
}

TEST(FileDescriptor, AFailureIsNamed) {
  try {
    const FileDescriptor missing(::open("/nowhere/at/all", O_RDONLY | O_CLOEXEC), "the thing");
    FAIL();
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::no_such_file_or_directory);
    EXPECT_NE(std::string(error.what()).find("the thing"), std::string::npos);
  }
}

}  // namespace file_descriptor_test
}  // namespace nodmap::formats
