// Whole files in and out: what the system refuses is told as what it is, and what killed processes left is swept.
#include "base/files.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using test::badInputMessage;
using test::contains;
using test::TempFolder;

// Root may read everything: nobody may not.
TEST(Files, PermissionDeniedIsToldAsSuch) {
  const TempFolder folder;
  const fs::path closed = folder / "closed";
  folder.write("closed/a.txt", "x");
  fs::permissions(closed, fs::perms::none);
  const bool root = ::geteuid() == 0;
  ASSERT_EQ(root ? ::seteuid(65534) : 0, 0);
  const std::string read = badInputMessage([&] { readFileText(closed / "a.txt"); }),
                    written = badInputMessage([&] { writeFileAtomically(closed / "b.txt", "x"); });
  ASSERT_EQ(root ? ::seteuid(0) : 0, 0);
  fs::permissions(closed, fs::perms::owner_all);
  EXPECT_TRUE(contains(read, "a.txt: cannot be opened: Permission denied")) << read;
  EXPECT_TRUE(contains(written, "b.txt: cannot be written: Permission denied")) << written;
}

TEST(Files, LinksInACircleAndTooFewDescriptorsAreToldAsSuch) {
  const TempFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_TRUE(contains(badInputMessage([&] { readFileText(folder / "a"); }), "Too many levels of symbolic links"));
  EXPECT_TRUE(contains(badInputMessage([&] { readFileText(folder / "none"); }), "none: no such file"));
  const fs::path file = folder.write("c", "x");
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit none = before;
  none.rlim_cur = 0;
  setrlimit(RLIMIT_NOFILE, &none);
  std::string message;
  ErrorKind kind = ErrorKind::fault;
  try {
    readFileText(file);
  } catch (const Error& error) { message = error.what(), kind = error.kind(); }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(kind, ErrorKind::missingCapability);
  EXPECT_TRUE(contains(message, "c: cannot be opened: Too many open files")) << message;
}

TEST(Files, LargeAndEmptyFilesAreReadWhole) {
  const TempFolder folder;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, (std::size_t{1} << 20) - 1, std::size_t{1} << 20,
                                 (std::size_t{1} << 20) + 1, std::size_t{5000000}}) {
    std::string content(size, 'x');
    if (size > 0) content.back() = 'y';
    EXPECT_EQ(readFileText(folder.write("a", content)), content) << size;
  }
  EXPECT_TRUE(contains(readFileText("/proc/self/status"), "VmSize"));  // of no size that the system tells
}

/// Writes to `file` in a process of its own that is killed in the middle.
pid_t killedWriter(const fs::path& file) {
  const pid_t child = ::fork();
  if (child == 0) {
    rlimit small{};
    small.rlim_cur = small.rlim_max = 1000;
    setrlimit(RLIMIT_FSIZE, &small);
    rlimit noCore{};
    setrlimit(RLIMIT_CORE, &noCore);
    std::signal(SIGXFSZ, SIG_DFL);  // ends the process at the byte beyond the limit
    writeFileAtomically(file, std::string(5000, 'x'));
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  return child;
}

TEST(Files, WhatKilledWritersLeftIsSweptAndNothingElse) {
  const TempFolder folder;
  const pid_t dead = killedWriter(folder / "a.txt");
  const std::string left = folder.listing();
  ASSERT_TRUE(contains(left, ".lucerna-") && contains(left, fmt::format("-{}-", dead))) << left;
  // Of a process that lives, of another machine, and of somebody else: kept.
  std::string alive = left;
  alive.replace(alive.find(std::to_string(dead)), std::to_string(dead).size(), std::to_string(::getppid()));
  std::string elsewhere = left;
  elsewhere.replace(9, 8, "00000000");
  folder.write(alive, "x");
  folder.write(elsewhere, "x");
  folder.write(".other.tmp", "x");
  writeFileAtomically(folder / "b.txt", "new");
  EXPECT_FALSE(fs::exists(folder / left)) << folder.listing();
  for (const std::string& kept : {alive, elsewhere, std::string(".other.tmp"), std::string("b.txt")})
    EXPECT_TRUE(fs::exists(folder / kept)) << kept;
}

}  // namespace
}  // namespace lucerna
