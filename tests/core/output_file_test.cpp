// SPDX-License-Identifier: Apache-2.0
// Files are replaced as a whole or stay as they were, whatever the name leads to.
#include "aureole/core/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "aureole/core/error.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string write_error(const fs::path& file) {
  try {
    write_file_atomically(file, std::string("text"));
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
std::string check_error(const fs::path& file) {
  try {
    require_writable(file);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
std::ptrdiff_t count(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(OutputFile, ReplacesFilesAsAWhole) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("f", "old");
  write_file_atomically(file, std::string("new contents"));
  EXPECT_EQ(content(file), "new contents");
  EXPECT_EQ(count(folder.path), 1) << "nothing is left beside it";
  EXPECT_NE(write_error(folder.path / "no/such/folder/f").find("there is no folder"), std::string::npos);
}

TEST(OutputFile, LinksStayLinks) {
  const TemporaryFolder folder;
  folder.write("f", "old");
  fs::create_symlink("f", folder.path / "link");
  write_file_atomically(folder.path / "link", std::string("through"));
  EXPECT_TRUE(fs::is_symlink(folder.path / "link"));
  EXPECT_EQ(content(folder.path / "f"), "through");
  // A dangling link, by way of another one, in another folder.
  fs::create_directory(folder.path / "sub");
  fs::create_symlink("sub/second", folder.path / "first");
  fs::create_symlink("new", folder.path / "sub/second");
  EXPECT_EQ(check_error(folder.path / "first"), "");
  write_file_atomically(folder.path / "first", std::string("far"));
  EXPECT_EQ(content(folder.path / "sub/new"), "far");
  EXPECT_TRUE(fs::is_symlink(folder.path / "first") && fs::is_symlink(folder.path / "sub/second"));
  // Links without an end, or into a folder that is not there.
  fs::create_symlink("loop", folder.path / "loop");
  fs::create_symlink("nowhere/f", folder.path / "gone");
  EXPECT_NE(check_error(folder.path / "loop").find("symbolic links"), std::string::npos);
  EXPECT_NE(check_error(folder.path / "gone").find("there is no folder"), std::string::npos);
}

TEST(OutputFile, PipesAndFoldersAreRefusedWithoutWaiting) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path / "pipe").c_str(), 0600), 0);
  for (const auto& error : {check_error(folder.path / "pipe"), write_error(folder.path / "pipe")})
    EXPECT_NE(error.find("cannot be written: it is a pipe"), std::string::npos) << error;
  for (const auto& error : {check_error(folder.path), write_error(folder.path)})
    EXPECT_NE(error.find("cannot be written: it is a folder"), std::string::npos) << error;
  EXPECT_EQ(check_error("/dev/null") + write_error("/dev/null"), "");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_NE(write_error("/dev/full").find("No space left"), std::string::npos);
}

TEST(OutputFile, NamesAsLongAsTheFileSystemAllows) {
  const TemporaryFolder folder;
  for (const std::size_t size : {249, 255}) {
    const fs::path file = folder.path / std::string(size, 'a');
    EXPECT_EQ(check_error(file) + write_error(file), "");
    EXPECT_EQ(content(file), "text");
  }
  EXPECT_NE(check_error(folder.path / std::string(256, 'a')).find("has 256 bytes"), std::string::npos);
}

TEST(OutputFile, LeftoversOfKilledProgramsAreRemoved) {
  const TemporaryFolder folder;
  const fs::path file = folder.path / "out.exr";
  const fs::path left = folder.write("out.exr.part-4711-0", "half"),
                 other = folder.write("b.exr.part-4711-0", ""), own = folder.write("out.exr.part-a", ""),
                 written = folder.write("out.exr.part-4712-3", "half");
  const int d = ::open(written.c_str(), O_WRONLY | O_CLOEXEC);
  ASSERT_EQ(::flock(d, LOCK_EX), 0);
  EXPECT_EQ(check_error(file), "");
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(written)) << "another program is writing it";
  EXPECT_TRUE(fs::exists(other) && fs::exists(own));
  ::close(d);
  EXPECT_EQ(check_error(file), "");
  EXPECT_FALSE(fs::exists(written));
}

TEST(OutputFile, FoldersOfKilledProgramsAreRemoved) {
  const TemporaryFolder folder;
  folder.write("out.part-4711-0/a.png", "half");
  folder.write("out.part-4711-0-old/result.json", "the result before, which is moved aside for a moment");
  fs::path made;
  {
    const PartFolder part(folder.path / "out");
    made = part.path();
    EXPECT_TRUE(fs::is_directory(made));
    EXPECT_FALSE(fs::exists(folder.path / "out.part-4711-0"));
    EXPECT_TRUE(fs::exists(folder.path / "out.part-4711-0-old/result.json"));
    const PartFolder second(folder.path / "out");
    EXPECT_TRUE(fs::exists(made)) << "it is in use";
  }
  EXPECT_FALSE(fs::exists(made));
}

TEST(OutputFile, OneHolderOfTheRightToWrite) {
  const TemporaryFolder folder;
  const auto error = [&](const char* name) {
    try {
      const OutputLock lock(folder.path / name);
      return std::string();
    } catch (const Error& e) {
      return std::string(e.what());
    }
  };
  {
    const OutputLock held(folder.path / "a.exr");
    EXPECT_NE(error("a.exr").find("by another program"), std::string::npos);
    EXPECT_NE(error("a.hdr").find("by another program"), std::string::npos) << "both have a.png";
    EXPECT_EQ(error("b.exr"), "");
  }
  EXPECT_EQ(error("a.exr"), "");
  EXPECT_EQ(count(folder.path), 0) << "no lock is left";
}

TEST(OutputFile, WhatCannotBeWrittenGoesElsewhere) {
  const TemporaryFolder folder;
  int calls = 0;
  const auto write = [&](const fs::path& file) {
    // The first two fail, as a folder that is gone and a full disc.
    if (++calls < 3) throw Error("no. " + std::to_string(calls));
    write_file_atomically(file, std::string("text"));
  };
  const WrittenFile written = write_somewhere(folder.path / "gone/a.exr", write);
  EXPECT_EQ(written.problem, "no. 1");
  EXPECT_EQ(content(written.file), "text");
  EXPECT_NE(written.file.filename().string().find("a.exr"), std::string::npos);
  fs::remove(written.file);
  EXPECT_THROW(write_somewhere(folder.path / "a", [](const fs::path&) { throw Error("never"); }), Error);
  EXPECT_EQ(write_somewhere(folder.path / "a", [](const fs::path&) {}).problem, "");
}

}  // namespace
}  // namespace aureole
