// SPDX-License-Identifier: Apache-2.0
// Kept tables: what is written is read, by any number of processes; damage, other versions, full and missing folders
// cost time and a note, never a wrong table; the size has its bound.
#include "aureole/core/table_cache.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "aureole/core/error.h"
#include "aureole/core/table_fields.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

TableKey key_of(std::uint64_t number, const std::string& table = "test table", int version = 3) {
  return {table, version, {number, ~number}, "test plug-in"};
}

/// The content of the table with this number.
KeptTable table_of(std::uint64_t number, std::size_t size) {
  KeptTable table;
  std::mt19937_64 random(number);
  for (std::size_t i = 0; i < size; ++i) table.bytes.push_back(char(random()));
  table.reads = {0, 3, std::uint32_t(number)};
  table.notes = {{"radius", "is number " + std::to_string(number)}};
  return table;
}

bool is_table(const KeptTable& found, std::uint64_t number, std::size_t size) {
  const KeptTable made = table_of(number, size);
  return found.bytes == made.bytes && found.reads == made.reads && found.notes == made.notes;
}

void set_time(const std::filesystem::path& file, time_t seconds) {
  const timespec times[2] = {{seconds, 0}, {seconds, 0}};
  ASSERT_EQ(utimensat(AT_FDCWD, file.c_str(), times, 0), 0);
}

std::size_t count_files(const std::filesystem::path& folder, const std::string& part) {
  std::size_t count = 0;
  for (const auto& e : std::filesystem::directory_iterator(folder))
    count += e.path().filename().string().find(part) != std::string::npos;
  return count;
}

struct Cell {
  float begin = 0;
  int at = 0;
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.begin, self.at);
  }
  bool operator==(const Cell&) const = default;
};

enum class Side : unsigned char { above, below };

struct Mixed {
  double number = 0;
  bool flag = false;
  Side side = Side::above;
  std::string name;
  std::vector<float> values;
  std::vector<Cell> cells;
  std::array<std::int16_t, 3> three{};
  float pair[2] = {0, 0};
  std::optional<Cell> maybe, nothing;
  std::shared_ptr<const Cell> shared, null;
  std::vector<std::string> names;

  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.number, self.flag, self.side, self.name, self.values, self.cells, self.three, self.pair,
        self.maybe, self.nothing, self.shared, self.null, self.names);
  }
};

Mixed mixed() {
  Mixed m;
  m.number = -0.1, m.flag = true, m.side = Side::below, m.name = "glass";
  m.values = {1.5f, -2, 3}, m.cells = {{0.25f, 7}, {0.5f, -8}}, m.three = {-1, 2, 300};
  m.pair[0] = 4, m.pair[1] = 5, m.maybe = Cell{6, 7}, m.nothing = {};
  m.shared = std::make_shared<const Cell>(Cell{8, 9}), m.names = {"", "a", "bc"};
  return m;
}

TEST(TableFields, AllKindsOfMembersComeBack) {
  TableWriter writer;
  const Mixed written = mixed();
  Mixed::fields(written, writer);
  Mixed m;
  m.nothing = Cell{}, m.null = std::make_shared<const Cell>();
  TableReader reader(writer.bytes());
  Mixed::fields(m, reader);
  EXPECT_TRUE(reader.is_complete());
  EXPECT_EQ(m.number, written.number);
  EXPECT_TRUE(m.flag);
  EXPECT_EQ(m.side, Side::below);
  EXPECT_EQ(m.name, "glass");
  EXPECT_EQ(m.values, written.values);
  EXPECT_EQ(m.cells, written.cells);
  EXPECT_EQ(m.three, written.three);
  EXPECT_EQ(m.pair[1], 5);
  EXPECT_EQ(m.maybe, written.maybe);
  EXPECT_FALSE(m.nothing);
  EXPECT_EQ(*m.shared, *written.shared);
  EXPECT_FALSE(m.null);
  EXPECT_EQ(m.names, written.names);
}

TEST(TableFields, EveryTruncationAndExtensionIsFoundOut) {
  TableWriter writer;
  const Mixed written = mixed();
  Mixed::fields(written, writer);
  const std::vector<char> bytes = writer.bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Mixed m;
    TableReader reader(std::span(bytes.data(), size));
    Mixed::fields(m, reader);
    EXPECT_FALSE(reader.is_complete()) << size;
  }
  std::vector<char> longer = bytes;
  longer.push_back(0);
  Mixed m;
  TableReader reader(longer);
  Mixed::fields(m, reader);
  EXPECT_FALSE(reader.is_complete());
}

TEST(TableFields, DamagedBytesNeverCauseHugeMemory) {
  TableWriter writer;
  const Mixed written = mixed();
  Mixed::fields(written, writer);
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    std::vector<char> bytes = writer.bytes();
    for (int k = 0; k < 1 + i % 4; ++k) bytes[random() % bytes.size()] = char(random());
    Mixed m;
    TableReader reader(bytes);
    Mixed::fields(m, reader);
    EXPECT_LE(m.values.size() + m.cells.size() + m.names.size() + m.name.size(), 4 * bytes.size());
  }
}

class TableCaches : public ::testing::Test {
protected:
  TableCache cache(double least_seconds = 0) const {
    return TableCache(folder.path / "tables", least_seconds);
  }
  TemporaryFolder folder;
};

TEST_F(TableCaches, ATableIsFoundWithItsNotes) {
  TableCache writer(folder.path / "a" / "b", 0);
  EXPECT_FALSE(writer.find(key_of(1)));
  writer.keep(key_of(1), table_of(1, 5000), 2.5);
  EXPECT_EQ(writer.tables_kept(), 1u);
  TableCache reader(folder.path / "a" / "b");
  const auto found = reader.find(key_of(1));
  ASSERT_TRUE(found);
  EXPECT_TRUE(is_table(*found, 1, 5000));
  EXPECT_EQ(reader.tables_read(), 1u);
  EXPECT_FALSE(reader.find(key_of(2)));
  EXPECT_FALSE(reader.find(key_of(1, "other table")));
  EXPECT_FALSE(reader.find(key_of(1, "test table", 4))) << "another version of the table";
  EXPECT_TRUE(reader.take_notes().empty());

  const auto entries = reader.entries();
  ASSERT_EQ(entries.size(), 1u);
  EXPECT_EQ(entries[0].table, "test table");
  EXPECT_EQ(entries[0].made_for, "test plug-in");
  EXPECT_EQ(entries[0].seconds, 2.5);
  EXPECT_EQ(entries[0].build, table_build());
  EXPECT_EQ(entries[0].bytes, std::filesystem::file_size(entries[0].file));
}

TEST_F(TableCaches, QuickTablesAreNotKept) {
  TableCache c = cache(0.02);
  c.keep(key_of(1), table_of(1, 100), 0.019);
  EXPECT_FALSE(c.find(key_of(1)));
  c.keep(key_of(1), table_of(1, 100), 0.021);
  EXPECT_TRUE(c.find(key_of(1)));
}

TEST_F(TableCaches, EveryFlippedBitIsFoundOut) {
  TableCache writer = cache();
  writer.keep(key_of(7), table_of(7, 300), 1);
  const std::filesystem::path file = writer.file_of(key_of(7));
  const std::string good = file_content(file);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = char(bad[bit / 8] ^ (1 << (bit % 8)));
    std::ofstream(file, std::ios::binary) << bad;
    TableCache reader = cache();
    EXPECT_FALSE(reader.find(key_of(7))) << "bit " << bit;
    const auto notes = reader.take_notes();
    ASSERT_EQ(notes.size(), 1u) << "bit " << bit;
    EXPECT_NE(notes[0].find(file.string()), std::string::npos) << notes[0];
    EXPECT_NE(notes[0].find("computed again"), std::string::npos) << notes[0];
  }
  // The table is written anew over the damaged one.
  writer.keep(key_of(7), table_of(7, 300), 1);
  EXPECT_EQ(file_content(file), good);
}

TEST_F(TableCaches, EveryTruncationIsFoundOut) {
  TableCache writer = cache();
  writer.keep(key_of(7), table_of(7, 300), 1);
  const std::filesystem::path file = writer.file_of(key_of(7));
  const std::string good = file_content(file);
  for (std::size_t size = 0; size < good.size(); ++size) {
    std::ofstream(file, std::ios::binary) << good.substr(0, size);
    EXPECT_FALSE(cache().find(key_of(7))) << size;
    EXPECT_EQ(cache().entries().size(), 1u);
  }
  std::ofstream(file, std::ios::binary) << good << "x";
  EXPECT_FALSE(cache().find(key_of(7)));
}

TEST_F(TableCaches, AnotherTableUnderTheNameIsNotTaken) {
  TableCache c = cache();
  c.keep(key_of(1), table_of(1, 50), 1);
  c.keep(key_of(2), table_of(2, 50), 1);
  c.keep(key_of(1, "test table", 4), table_of(3, 50), 1);
  for (const TableKey& other : {key_of(2), key_of(1, "test table", 4)}) {
    std::filesystem::copy_file(c.file_of(other), c.file_of(key_of(1)),
                               std::filesystem::copy_options::overwrite_existing);
    TableCache reader = cache();
    EXPECT_FALSE(reader.find(key_of(1)));
    const auto notes = reader.take_notes();
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("another version"), std::string::npos) << notes[0];
  }
}

TEST_F(TableCaches, OtherKindsOfFilesUnderTheName) {
  TableCache c = cache();
  c.keep(key_of(1), table_of(1, 50), 1);
  const std::filesystem::path file = c.file_of(key_of(1));
  std::filesystem::remove(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_FALSE(c.find(key_of(1))) << "a pipe does not block";
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_FALSE(c.find(key_of(1)));
  c.keep(key_of(1), table_of(1, 50), 1);
  EXPECT_FALSE(c.take_notes().empty());
  std::filesystem::remove(file);
  std::filesystem::create_symlink(file, file);
  EXPECT_FALSE(c.find(key_of(1)));
}

TEST_F(TableCaches, TheTablesThatWereUsedLongestAgoGoFirst) {
  TableCache c = cache();
  c.set_limit(10000);
  for (int i = 0; i < 4; ++i) {
    c.keep(key_of(i), table_of(i, 2000), 1);
    set_time(c.file_of(key_of(i)), 1000 + i);
  }
  EXPECT_EQ(c.entries().size(), 4u);
  EXPECT_TRUE(c.find(key_of(0))) << "which makes table 1 the oldest";
  c.keep(key_of(4), table_of(4, 2000), 1);
  EXPECT_FALSE(c.find(key_of(1)));
  for (const int i : {0, 2, 3, 4}) EXPECT_TRUE(c.find(key_of(i))) << i;
  std::uint64_t sum = 0;
  for (const TableEntry& e : c.entries()) sum += e.bytes;
  EXPECT_LE(sum, 10000u);
  EXPECT_TRUE(c.take_notes().empty());

  EXPECT_EQ(cache().limit(), 10000u) << "the bound is the folder's";
  c.set_limit(5000);
  EXPECT_EQ(c.entries().size(), 2u);
  c.set_limit(0);
  EXPECT_TRUE(c.entries().empty());
  c.keep(key_of(1), table_of(1, 10), 1);
  EXPECT_TRUE(c.entries().empty());
}

TEST_F(TableCaches, ATableOfMoreThanAQuarterOfTheBoundIsNotKept) {
  TableCache c = cache();
  c.set_limit(8000);
  c.keep(key_of(1), table_of(1, 1500), 1);
  c.keep(key_of(2), table_of(2, 2001), 1);
  EXPECT_TRUE(c.find(key_of(1)));
  EXPECT_FALSE(c.find(key_of(2)));
  const auto notes = c.take_notes();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("a quarter of the 0.008 MB"), std::string::npos) << notes[0];
}

TEST_F(TableCaches, ADamagedBoundIsTheUsualOne) {
  TableCache c = cache();
  c.set_limit(5000);
  for (const char* text : {"", "x", "-5", "99999999999999999999999", "12x"}) {
    std::ofstream(c.folder() / "limit") << text;
    EXPECT_EQ(c.limit(), TableCache::kUsualLimit) << text;
  }
  std::ofstream(c.folder() / "limit") << "123";
  EXPECT_EQ(c.limit(), 123u);
}

TEST_F(TableCaches, ClearLeavesFilesOfOthers) {
  TableCache c = cache();
  c.set_limit(1000000);
  for (int i = 0; i < 3; ++i) c.keep(key_of(i), table_of(i, 100), 1);
  for (const char* name : {"mine.table", "picture.exr.part-1-2", "0123456789abcdef0123456789abcdeF.table"})
    std::ofstream(c.folder() / name) << "x";
  const std::string killed = "0123456789abcdef0123456789abcdef.table.part-1-2";
  std::ofstream(c.folder() / killed) << "x";
  EXPECT_EQ(c.clear(), 3u);
  EXPECT_TRUE(c.entries().empty());
  EXPECT_FALSE(std::filesystem::exists(c.folder() / killed));
  for (const char* name : {"mine.table", "picture.exr.part-1-2", "0123456789abcdef0123456789abcdeF.table"})
    EXPECT_TRUE(std::filesystem::exists(c.folder() / name)) << name;
  EXPECT_EQ(c.limit(), 1000000u);
  EXPECT_EQ(TableCache(folder.path / "none").clear(), 0u);
}

TEST_F(TableCaches, WithoutAFolderThereIsOneNote) {
  std::ofstream(folder.path / "file") << "x";
  TableCache c(folder.path / "file" / "tables", 0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(c.find(key_of(i)));
    c.keep(key_of(i), table_of(i, 100), 1);
  }
  EXPECT_EQ(c.tables_kept(), 0u);
  const auto notes = c.take_notes();
  ASSERT_EQ(notes.size(), 1u) << ::testing::PrintToString(notes);
  EXPECT_NE(notes[0].find("tables are not kept"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find((folder.path / "file").string()), std::string::npos) << notes[0];
  EXPECT_TRUE(c.entries().empty());
}

/// Calls `use` in another process and returns its status.
template <class Use>
int in_child(const Use& use) {
  const pid_t pid = fork();
  if (pid == 0) _exit(use() ? 0 : 1);
  int status = 0;
  waitpid(pid, &status, 0);
  return status;
}

TEST_F(TableCaches, OnAFullDiscThereIsOneNote) {
  cache().keep(key_of(1), table_of(1, 100), 1);
  EXPECT_EQ(in_child([&] {
              const rlimit small{4096, 4096};
              if (setrlimit(RLIMIT_FSIZE, &small) != 0 || ::signal(SIGXFSZ, SIG_IGN) == SIG_ERR) return false;
              TableCache c = cache();
              c.keep(key_of(2), table_of(2, 100000), 1);
              c.keep(key_of(3), table_of(3, 100000), 1);
              const auto notes = c.take_notes();
              return notes.size() == 1 && c.tables_kept() == 0 && c.find(key_of(1)).has_value();
            }),
            0);
  EXPECT_FALSE(cache().find(key_of(2)));
  EXPECT_EQ(count_files(folder.path / "tables", ".part-"), 0u);
}

TEST_F(TableCaches, AFolderThatCannotBeWrittenIsReadAllTheSame) {
  cache().keep(key_of(1), table_of(1, 100), 1);
  const auto tables = folder.path / "tables";
  ASSERT_EQ(chmod(tables.c_str(), 0555), 0);
  // The superuser writes everywhere; another user reads, if the folders above let him.
  EXPECT_EQ(in_child([&] {
              if (geteuid() == 0) {
                for (auto above = tables; above.has_relative_path(); above = above.parent_path())
                  if (::access(above.c_str(), X_OK) != 0) return true;
                if (setegid(65534) != 0 || seteuid(65534) != 0) return true;
              }
              TableCache c = cache();
              if (!c.find(key_of(1))) return false;
              c.keep(key_of(2), table_of(2, 100), 1);
              c.keep(key_of(3), table_of(3, 100), 1);
              return c.take_notes().size() == 1 && !c.find(key_of(2));
            }),
            0);
  chmod(tables.c_str(), 0755);
}

TEST_F(TableCaches, ProcessesThatWriteReadAndRemoveAtOnce) {
  constexpr int kProcesses = 4, kKeys = 12;
  const auto size_of = [](std::uint64_t i) { return std::size_t(1000 + 3000 * i); };
  cache().set_limit(4 * size_of(kKeys));  // room for some of them: each process removes what others read
  std::vector<pid_t> children;
  for (int c = 0; c < kProcesses; ++c) {
    const pid_t pid = fork();
    if (pid == 0) {
      TableCache own = cache();
      std::mt19937 random(unsigned(100 + c));
      bool good = true;
      for (int i = 0; i < 150; ++i) {
        const std::uint64_t number = random() % kKeys;
        if (const auto found = own.find(key_of(number)))
          good = good && is_table(*found, number, size_of(number));
        else
          own.keep(key_of(number), table_of(number, size_of(number)), 1);
      }
      good = good && own.take_notes().empty() && own.tables_read() > 0 && own.tables_kept() > 0;
      _exit(good ? 0 : 1);
    }
    children.push_back(pid);
  }
  for (const pid_t pid : children) {
    int status = 1;
    waitpid(pid, &status, 0);
    EXPECT_EQ(status, 0);
  }
  std::uint64_t sum = 0;
  for (const TableEntry& e : cache().entries()) sum += e.bytes;
  EXPECT_LE(sum, 4 * size_of(kKeys));
  EXPECT_EQ(count_files(folder.path / "tables", ".part-"), 0u);
}

TEST_F(TableCaches, AProgramThatIsKilledWhileItWrites) {
  constexpr std::size_t kSize = std::size_t(4) << 20;
  const KeptTable large = table_of(1, kSize);
  int with_leftovers = 0;
  // On a busy machine the first program may be killed before it makes the folder.
  std::filesystem::create_directories(folder.path / "tables");
  for (int i = 0; i < 12; ++i) {
    const pid_t pid = fork();
    if (pid == 0) {
      TableCache own = cache();
      for (;;) own.keep(key_of(1), large, 1);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10 + 7 * i));
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    with_leftovers += count_files(folder.path / "tables", ".part-") > 0;
    TableCache own = cache();
    const auto found = own.find(key_of(1));
    EXPECT_TRUE(!found || is_table(*found, 1, kSize));
    EXPECT_TRUE(own.take_notes().empty()) << "a table is whole or not there";
  }
  EXPECT_GT(with_leftovers, 0) << "the test has killed no program while it wrote";
  // A program that was killed while it wrote the tag of the folder.
  std::ofstream(folder.path / "tables" / "CACHEDIR.TAG.part-4000000-0") << "Signa";
  cache().keep(key_of(2), table_of(2, 10), 1);
  EXPECT_EQ(count_files(folder.path / "tables", ".part-"), 0u) << "the next writer removes unfinished files";
}

/// Sets an environment variable for a scope; null removes it.
class Environment {
public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value ? setenv(name, value, 1) : unsetenv(name);
  }
  ~Environment() { before_ ? setenv(name_, before_->c_str(), 1) : unsetenv(name_); }

private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(TableCacheFolder, IsTheChosenOneOrThatOfTheEnvironment) {
  const Environment variable("AUREOLE_CACHE", nullptr), xdg("XDG_CACHE_HOME", "/some/cache"),
      home("HOME", "/home/anybody");
  EXPECT_EQ(TableCache::chosen("")->folder(), "/some/cache/aureole");
  EXPECT_EQ(TableCache::chosen("/there")->folder(), "/there");
  EXPECT_EQ(TableCache::chosen("there")->folder(), std::filesystem::current_path() / "there");
  EXPECT_EQ(TableCache::chosen("off"), nullptr);
  {
    const Environment off("AUREOLE_CACHE", "off");
    EXPECT_EQ(TableCache::chosen(""), nullptr);
    EXPECT_EQ(TableCache::chosen("/there")->folder(), "/there");
  }
  {
    const Environment elsewhere("AUREOLE_CACHE", "/elsewhere");
    EXPECT_EQ(TableCache::chosen("")->folder(), "/elsewhere");
  }
  {
    const Environment relative("XDG_CACHE_HOME", "cache");
    EXPECT_EQ(TableCache::chosen("")->folder(), "/home/anybody/.cache/aureole");
    const Environment nowhere("HOME", nullptr);
    EXPECT_EQ(TableCache::chosen(""), nullptr);
  }
}

TEST(TableCacheFolder, NumbersOfBytes) {
  EXPECT_EQ(parse_bytes("1000000"), 1000000u);
  EXPECT_EQ(parse_bytes("500MB"), 500000000u);
  EXPECT_EQ(parse_bytes("1.5 GB"), 1500000000u);
  EXPECT_EQ(parse_bytes("2GiB"), std::uint64_t(2) << 30);
  EXPECT_EQ(parse_bytes("0"), 0u);
  for (const char* text : {"", "MB", "-5", "5 apples", "1e3", "5mb", "99999999999TB", "1.2.3"})
    EXPECT_THROW(parse_bytes(text), Error) << text;
}

}  // namespace
}  // namespace aureole::test
