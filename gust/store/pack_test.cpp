#include "gust/store/pack.h"

#include <doctest/doctest.h>
#include <zstd.h>

#include <array>
#include <sstream>

#include "gust/core/hash.h"
#include "gust/store/files_test_folder.h"

using namespace gust;

namespace fs = std::filesystem;

namespace {

void commit_trial(const Store& store, std::string_view kind, std::string_view id, const std::string& content) {
  TrialWriter writer = store.begin(kind, id);
  writer.write("rows.bin", content);
  writer.write("empty", "");
  writer.commit(cat("text of ", id));
}

std::string noise(std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; bytes.size() < size; ++i) bytes += hash_hex(cat(i));
  return bytes;
}

/// The bytes of a pack with this content in its frame.
std::string pack_of(const std::string& content) {
  std::string frame(ZSTD_compressBound(content.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), content.size(), 1));
  return "gust pack 1\n" + frame;
}

std::string length_bytes(std::uint32_t length) { return {reinterpret_cast<const char*>(&length), sizeof length}; }

std::string entry(const Manifest& manifest, const std::string& content) {
  const std::string bytes = manifest_bytes(manifest);
  return length_bytes(static_cast<std::uint32_t>(bytes.size())) + bytes + content;
}

std::string complaint_of(const std::string& pack) {
  return message_of([&] {
    std::istringstream stream(pack);
    PackVisitor heedless;
    read_pack(stream, "p", heedless);
  });
}

}  // namespace

TEST_CASE("a pack carries the trials of a store to another, manifests and all") {
  const TestFolder folder;
  const Store from(folder / "from", Store::Access::write);
  commit_trial(from, "sweep", "b", noise(300'000));
  commit_trial(from, "sweep", "a", "numbers");
  commit_trial(from, "train", "a", "weights");
  std::string told;
  const Store to(folder / "to", Store::Access::write, [&](const std::string& text) { told += text; });
  commit_trial(to, "sweep", "a", "its own");

  const PackCount packed = pack_store(from, folder / "file.pack");
  const PackCount unpacked = unpack_store(folder / "file.pack", to);

  CHECK(packed.trials == 3);
  CHECK(packed.bytes == fs::file_size(folder / "file.pack"));
  CHECK(unpacked.trials == 2);
  CHECK(unpacked.present == 1);
  CHECK(unpacked.disagreeing == 1);
  CHECK(told.find(cat("two results for one trial: ", (folder / "to/sweep/a").string())) == 0);
  CHECK(told.find(cat((folder / "file.pack").string(), ": sweep/a (gust ")) != told.npos);
  CHECK(to.load("sweep", "a")->read("rows.bin") == "its own");
  CHECK(to.load("sweep", "b")->read("rows.bin") == noise(300'000));
  CHECK(to.load("train", "a")->manifest == from.load("train", "a")->manifest);
}

TEST_CASE("equal trials make equal packs, whatever the order in which they came") {
  const TestFolder folder;
  const Store one(folder / "one", Store::Access::write);
  const Store two(folder / "two", Store::Access::write);
  for (const char* id : {"a", "b", "c"}) commit_trial(one, "sweep", id, id);
  for (const char* id : {"c", "a", "b"}) commit_trial(two, "sweep", id, id);
  const Store three(folder / "three", Store::Access::write);

  pack_store(one, folder / "1.pack");
  pack_store(two, folder / "2.pack");
  unpack_store(folder / "1.pack", three);
  pack_store(three, folder / "3.pack");

  CHECK(get_file(folder / "1.pack") == get_file(folder / "2.pack"));
  CHECK(get_file(folder / "1.pack") == get_file(folder / "3.pack"));
}

TEST_CASE("a pack is put over nothing else than a pack") {
  const TestFolder folder;
  const Store store(folder / "store", Store::Access::write);
  pack_store(store, folder / "a.pack");
  commit_trial(store, "sweep", "a", "numbers");
  put_file(folder / "thesis.txt", "mine");
  fs::create_symlink("/dev/null", folder / "device");

  CHECK(pack_store(store, folder / "a.pack").trials == 1);
  CHECK(message_of([&] {
          pack_store(store, folder / "thesis.txt");
        }).ends_with("exists and is no pack; choose another name"));
  CHECK(get_file(folder / "thesis.txt") == "mine");
  CHECK(message_of([&] { pack_store(store, folder / "device"); }).ends_with("is no pack; choose another name"));
  CHECK(message_of([&] { pack_store(store, folder / std::string(300, 'x')); }).ends_with("File name too long"));
}

TEST_CASE("packing leaves a damaged trial out, and unpacking puts it right") {
  const TestFolder folder;
  std::string told;
  const Store store(folder / "s", Store::Access::write, [&](const std::string& text) { told += text; });
  commit_trial(store, "sweep", "a", "numbers");
  commit_trial(store, "sweep", "b", "numbers");
  pack_store(store, folder / "both.pack");
  put_file(folder / "s/sweep/a/rows.bin", "numbars");

  const PackCount packed = pack_store(Store(folder / "s", Store::Access::read), folder / "one.pack");
  CHECK(packed.trials == 1);
  CHECK(packed.damaged == 1);
  CHECK(pack_store(Store(folder / "s", Store::Access::read), folder / "none.pack", "no such kind").trials == 0);
  const PackCount count = unpack_store(folder / "both.pack", store);

  CHECK(count.trials == 1);
  CHECK(count.present == 1);
  CHECK(store.load("sweep", "a")->read("rows.bin") == "numbers");
  CHECK(told.find("its hash differs") != std::string::npos);
}

TEST_CASE("every damaged byte and every cut of a pack is noticed, and what came whole before it stays whole") {
  const TestFolder folder;
  const Store from(folder / "from", Store::Access::write);
  commit_trial(from, "sweep", "a", noise(1000));
  commit_trial(from, "sweep", "b", noise(2000));
  pack_store(from, folder / "good.pack");
  const std::string good = get_file(folder / "good.pack");
  REQUIRE(complaint_of(good) == "");
  std::size_t noticed = 0;

  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x04);
    noticed += complaint_of(bad).starts_with("p: ") ? 1 : 0;
    noticed += complaint_of(good.substr(0, i)).starts_with("p: ") ? 1 : 0;
  }
  put_file(folder / "cut.pack", good.substr(0, good.size() - 10));
  const Store to(folder / "to", Store::Access::write);
  const std::string complaint = message_of([&] { unpack_store(folder / "cut.pack", to); });

  // The header of a zstd frame has bits that mean nothing to us, such as the size of the window.
  CHECK(noticed >= 2 * good.size() - 8);
  CHECK(complaint.ends_with("cut.pack: damaged pack: cut short"));
  CHECK(message_of([&] { check_pack(folder / "cut.pack"); }) == complaint);
  CHECK(message_of([&] { check_pack(folder / "good.pack"); }).empty());
  for (const auto& [kind, id] : to.trials()) CHECK(to.load(kind, id));
  CHECK(!fs::exists(folder / "to/damaged"));
  CHECK(complaint_of(good + "x") == "p: damaged pack: something follows its end");
}

TEST_CASE("a pack made to do harm is refused and writes nothing") {
  const TestFolder folder;
  const Manifest fine = {"sweep", "a", "", "", {{"rows.bin", 7, hash_hex("numbers")}}};
  Manifest outside = fine;
  outside.id = "../../outside";
  Manifest up = fine;
  up.files[0].name = "../../../up";
  Manifest huge = fine;
  huge.files[0].size = std::uint64_t{1} << 60;
  const std::string end = length_bytes(0);

  CHECK(complaint_of(pack_of(entry(fine, "numbers") + end)) == "");
  CHECK(complaint_of("") == "p: no pack of a gust store of format 1");
  CHECK(complaint_of(pack_of(end + end)) == "p: damaged pack: something follows its end");
  CHECK(complaint_of(pack_of(entry(fine, "numbers"))) == "p: damaged pack: cut short");
  CHECK(complaint_of(pack_of(entry(fine, "numbars") + end)) == "p: damaged pack: a/rows.bin: its hash differs");
  CHECK(complaint_of(pack_of(length_bytes(0xFFFFFFFF))) == "p: damaged pack: a manifest is too long");
  CHECK(complaint_of(pack_of(entry(huge, "numbers"))) == "p: damaged pack: cut short");
  CHECK(complaint_of(pack_of(entry(huge, std::string(200'000'000, '\0')))) ==
        "p: damaged pack: it expands without measure");
  const Store store(folder / "store", Store::Access::write);
  const auto before = count_below(folder.path());
  for (const Manifest& bad : {outside, up}) {
    put_file(folder / "bad.pack", pack_of(entry(bad, "numbers") + end));
    const std::string complaint = message_of([&] { unpack_store(folder / "bad.pack", store); });
    CHECK(complaint.ends_with("is not a plain name"));
  }
  CHECK(count_below(folder.path()) == before + 1);
}
