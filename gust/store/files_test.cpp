#include "gust/store/files.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <thread>

#include "gust/store/files_test_folder.h"

using namespace gust;

namespace fs = std::filesystem;

TEST_CASE("a file that was written reads back, and nothing else is left in its folder") {
  const TestFolder folder;
  const std::string bytes("a\0\nb\xff", 5);

  write_file_atomically(folder / "new/deep/file.bin", bytes);
  write_file_atomically(folder / "new/deep/file.bin", bytes + bytes);

  CHECK(read_file(folder / "new/deep/file.bin") == bytes + bytes);
  CHECK(count_below(folder.path()) == 3);
}

TEST_CASE("a file that is not committed leaves the old one as it was") {
  const TestFolder folder;
  put_file(folder / "file", "old");

  {
    AtomicFile file(folder / "file");
    file.append(std::string(200'000, 'x'));
  }

  CHECK(get_file(folder / "file") == "old");
  CHECK(count_below(folder.path()) == 1);
}

TEST_CASE("what a killed program left aside is taken over") {
  const TestFolder folder;
  put_file(folder / ".file.aside", "a much longer text that was never finished");

  write_file_atomically(folder / "file", "new");

  CHECK(get_file(folder / "file") == "new");
  CHECK(count_below(folder.path()) == 1);
}

TEST_CASE("many writers of one file leave the whole of one of them") {
  const TestFolder folder;

  {
    std::vector<std::jthread> writers;
    for (char letter = 'a'; letter < 'g'; ++letter) {
      writers.emplace_back([&, letter] {
        for (int i = 0; i < 20; ++i) write_file_atomically(folder / "file", std::string(100'000, letter));
      });
    }
  }

  const std::string bytes = get_file(folder / "file");
  CHECK(bytes == std::string(100'000, bytes.front()));
  CHECK(count_below(folder.path()) == 1);
}

TEST_CASE("a link is followed, and what is no regular file is written directly") {
  const TestFolder folder;
  put_file(folder / "there/target", "old");
  fs::create_symlink("there/target", folder / "link");
  fs::create_symlink("/dev/null", folder / "hole");

  write_file_atomically(folder / "link", "new");
  write_file_atomically(folder / "hole", "gone");

  CHECK(fs::is_symlink(folder / "link"));
  CHECK(get_file(folder / "there/target") == "new");
  CHECK(fs::is_character_file(fs::status(folder / "hole")));
}

TEST_CASE("a link to nothing is followed, through others, and stays") {
  const TestFolder folder;
  fs::create_directories(folder / "there");
  fs::create_symlink("there/second", folder / "first");
  fs::create_symlink("target", folder / "there/second");
  fs::create_symlink("loop", folder / "loop");

  write_file_atomically(folder / "first", "new");

  CHECK(fs::is_symlink(folder / "first"));
  CHECK(fs::is_symlink(folder / "there/second"));
  CHECK(get_file(folder / "there/target") == "new");
  CHECK(message_of([&] { write_file_atomically(folder / "loop", "x"); }).find("Too many levels of symbolic links") !=
        std::string::npos);
}

TEST_CASE("what is open already is written through its link, behind what is there, and a closed one is an error") {
  const TestFolder folder;
  put_file(folder / "file", "old, ");
  const Descriptor open = open_file(folder / "file", O_RDONLY);
  fs::create_symlink(cat("/proc/self/fd/", open.get()), folder / "open");
  fs::create_symlink("/proc/self/fd/999", folder / "closed");

  write_file_atomically(folder / "open", "new");

  CHECK(get_file(folder / "file") == "old, new");
  CHECK(is_stream(folder / "open"));
  CHECK_FALSE(is_stream(folder / "file"));
  CHECK(message_of([&] { write_file_atomically(folder / "closed", "x"); }).find("cannot write") != std::string::npos);
  CHECK(fs::is_symlink(folder / "closed"));
}

TEST_CASE("errors name the file and the reason") {
  const TestFolder folder;
  put_file(folder / "file", "text");
  const std::string base = folder.path().string();

  CHECK(message_of([&] { read_file(folder / "none"); }) == base + "/none: cannot read: No such file or directory");
  CHECK(message_of([&] { read_file(folder.path()); }) == base + ": cannot read: Is a directory");
  CHECK(message_of([&] { read_file("/dev/zero", 9999); }) == "/dev/zero: cannot read: longer than 9999 bytes");
  CHECK(message_of([&] { write_file_atomically(folder / "file/x", ""); }) ==
        base + "/file: cannot make the folder: Not a directory");
  CHECK(message_of([&] { write_file_atomically(folder.path(), ""); }) == base + ": cannot write: Is a directory");
  CHECK(message_of([&] { write_file_atomically("/proc/gust-test", ""); }).starts_with("/proc/gust-test: cannot write"));
  CHECK(message_of([&] { write_file_atomically("/dev/full", "x"); }) ==
        "/dev/full: cannot write: No space left on device");
}

TEST_CASE("a pipe keeps neither readers nor writers waiting") {
  const TestFolder folder;
  const fs::path pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);

  CHECK(message_of([&] { read_file(pipe); }) == pipe.string() + ": cannot read: it is a pipe; give a regular file");
  CHECK(message_of([&] { write_file_atomically(pipe, "x"); }) ==
        pipe.string() + ": cannot write: nobody reads from this pipe");
}

TEST_CASE("a pattern names files sorted by their bytes, relative to the base") {
  const TestFolder folder;
  for (const char* name : {"p/b.onnx", "p/a.onnx", "p/B.onnx", "p/.hidden.onnx", "p/c.txt", "q/a.onnx"}) {
    put_file(folder / name, "");
  }
  fs::create_directories(folder / "p/folder.onnx");
  const auto names = [&](std::string_view pattern) {
    std::string text;
    for (const fs::path& path : glob_files(folder.path(), pattern)) {
      text += path.lexically_relative(folder.path()).string() + " ";
    }
    return text;
  };

  CHECK(names("p/*.onnx") == "p/B.onnx p/a.onnx p/b.onnx ");
  CHECK(names("p/[ab].onnx") == "p/a.onnx p/b.onnx ");
  CHECK(names("*/a.on?x") == "p/a.onnx q/a.onnx ");
  CHECK(names((folder / "q/*").string()) == "q/a.onnx ");
  CHECK(names("p/z.onnx") == "p/z.onnx ");
  CHECK(names("z/*.onnx") == "");
}

namespace {

/// The files that a pattern names, relative to its base.
std::string found(const fs::path& base, std::string_view pattern) {
  std::string text;
  for (const fs::path& path : glob_files(base, pattern)) text += path.lexically_relative(base).string() + " ";
  return text;
}

}  // namespace

TEST_CASE("what is there by the very name of a part is meant, and a pattern only where it is not") {
  const TestFolder folder;
  for (const char* name : {"p1", "p[1]", "p[2]", "p3", "run[a]/x.onnx", "runa/x.onnx", "r[b]/p[4]", "r[b]/p4", "s*t"})
    put_file(folder / name, "");

  CHECK(found(folder.path(), "p[1]") == "p[1] ");
  CHECK(found(folder.path(), "p[3]") == "p3 ");
  CHECK(found(folder.path(), "p[13]") == "p1 p3 ");
  CHECK(found(folder.path(), "run[a]/*.onnx") == "run[a]/x.onnx ");
  CHECK(found(folder.path(), "r*/p[4]") == "r[b]/p[4] ");
  CHECK(found(folder.path(), "s*t") == "s*t ");
  CHECK(found(folder.path(), "p\\[?]") == "p[1] p[2] ");
  CHECK(found(folder / "r[b]", "p?") == "p4 ");
  CHECK(found(folder / "r[b]", "*") == "p4 p[4] ");
  CHECK(found(folder.path(), (folder / "r[b]/p*").string()) == "r[b]/p4 r[b]/p[4] ");
}

TEST_CASE("two stars are all folders below, this one included, hidden ones and links left out, each file once") {
  const TestFolder folder;
  for (const char* name : {"top.onnx", "runs/top.onnx", "runs/a/s1.onnx", "runs/b/x/s2.onnx", "runs/b/x/n.txt",
                           "runs/.git/s3.onnx", "elsewhere/s4.onnx"})
    put_file(folder / name, "");
  fs::create_directory_symlink(folder / "runs", folder / "runs/b/loop");
  fs::create_directory_symlink(folder / "elsewhere", folder / "runs/linked");
  fs::create_symlink(folder / "elsewhere/s4.onnx", folder / "runs/a/s4.onnx");

  const std::string all = "runs/a/s1.onnx runs/a/s4.onnx runs/b/x/s2.onnx runs/top.onnx ";
  CHECK(found(folder.path(), "runs/**/*.onnx") == all);
  CHECK(found(folder.path(), "runs/**/**/*.onnx") == all);
  CHECK(found(folder.path(), "runs/**/x/*.onnx") == "runs/b/x/s2.onnx ");
  CHECK(found(folder.path(), "**/s2.onnx") == "runs/b/x/s2.onnx ");
  CHECK(found(folder.path(), "runs/b/**") == "runs/b/x/n.txt runs/b/x/s2.onnx ");
  CHECK(found(folder / "runs/a", "../linked/**/*.onnx") == "../linked/s4.onnx ");
  CHECK(message_of([&] { found(folder.path(), "runs/**.onnx"); }) ==
        "'**' stands for folders and must be a part of its own, as in 'runs/**/*.onnx', got '**.onnx'");
}
