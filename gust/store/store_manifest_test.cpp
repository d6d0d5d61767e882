#include "gust/store/store_manifest.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "gust/core/hash.h"
#include "gust/store/files_test_folder.h"

using namespace gust;

namespace {

Manifest sample() {
  const std::string hash(32, 'a');
  return {
      "sweep", "lqr-1", "level = [0.1, 2]\nname = \"ü\\\"\"", "0.1.0", {{"rows.bin", 12, hash}, {"curve", 0, hash}}};
}

/// What parsing says of a manifest in which a key has another value, with the hash put right.
std::string complaint_with(const std::string& key, const nlohmann::json& value) {
  auto json = nlohmann::json::parse(manifest_bytes(sample()));
  json.erase("hash");
  json[nlohmann::json::json_pointer(key)] = value;
  json["hash"] = hash_hex(json.dump(1));
  return message_of([&] { parse_manifest(json.dump(), "m"); });
}

}  // namespace

TEST_CASE("a manifest reads back") { CHECK(parse_manifest(manifest_bytes(sample()), "m") == sample()); }

TEST_CASE("every changed byte and every cut of a manifest is noticed") {
  const std::string good = manifest_bytes(sample());
  std::size_t noticed = 0;

  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x01);
    noticed += message_of([&] { parse_manifest(bad, "m"); }).starts_with("m: damaged manifest: ") ? 1 : 0;
    const bool whole = i + 1 == good.size();  // the line break at the end means nothing
    noticed += message_of([&] { parse_manifest(good.substr(0, i), "m"); }).empty() == whole ? 1 : 0;
  }

  CHECK(noticed == 2 * good.size());
}

TEST_CASE("a manifest made to do harm is refused") {
  CHECK(complaint_with("/gust", "0.2.0") == "");
  CHECK(complaint_with("/format", 2) == "m: damaged manifest: it has another format");
  CHECK(complaint_with("/kind", "aside") == "m: damaged manifest: 'kind' is not the name of a kind");
  CHECK(complaint_with("/kind", "..") == "m: damaged manifest: 'kind' is not the name of a kind");
  CHECK(complaint_with("/id", "../../etc") == "m: damaged manifest: 'id' is not a plain name");
  CHECK(complaint_with("/id", "a/b") == "m: damaged manifest: 'id' is not a plain name");
  CHECK(complaint_with("/id", "") == "m: damaged manifest: 'id' is not a plain name");
  CHECK(complaint_with("/text", 3) == "m: damaged manifest: 'text' is not a text");
  CHECK(complaint_with("/files", 3) == "m: damaged manifest: 'files' is not a list");
  CHECK(complaint_with("/files/0", 3) == "m: damaged manifest: a file is not an object");
  CHECK(complaint_with("/files/0/name", "/etc/passwd") == "m: damaged manifest: 'name' is not a plain name");
  CHECK(complaint_with("/files/0/name", std::string("a\0b", 3)) == "m: damaged manifest: 'name' is not a plain name");
  CHECK(complaint_with("/files/0/name", "manifest.json") == "m: damaged manifest: two files have one name");
  CHECK(complaint_with("/files/0/name", "curve") == "m: damaged manifest: two files have one name");
  CHECK(complaint_with("/files/0/size", -1) == "m: damaged manifest: 'size' is not a count of bytes");
  CHECK(complaint_with("/files/0/size", 1e300) == "m: damaged manifest: 'size' is not a count of bytes");
  CHECK(complaint_with("/files/0/hash", "xyz") == "m: damaged manifest: 'hash' is not 32 hexadecimal digits");
}

TEST_CASE("a manifest that is nested a million deep is refused") {
  const std::string deep(1'000'000, '[');

  CHECK(message_of([&] { parse_manifest(deep, "m"); }) == "m: damaged manifest: not a JSON object");
  CHECK(message_of([&] { parse_manifest(R"({"hash":"x","a":)" + deep + std::string(1'000'000, ']') + "}", "m"); }) ==
        "m: damaged manifest: its hash differs");
}
