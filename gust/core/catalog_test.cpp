#include "gust/core/catalog.h"

#include <doctest/doctest.h>

using namespace gust;

namespace {

struct Pet {
  virtual ~Pet() = default;
  virtual double weight() const = 0;
};

struct Cat {
  double kilos = 4;
  static constexpr std::tuple kFields = {field("kilos", &Cat::kilos, "its weight", positive, "kg")};
};
struct CatPet : Pet {
  explicit CatPet(const Cat& options) : kilos(options.kilos) {}
  double weight() const override { return kilos; }
  double kilos;
};

const Catalog<Pet>& pets() {
  static const Catalog<Pet> catalog("pet", {make_entry<Pet, Cat>("cat", "Sleeps.", "own", [](const Cat& options) {
                                      return std::make_unique<CatPet>(options);
                                    })});
  return catalog;
}

Table table(std::initializer_list<std::pair<std::string, Value>> items) { return {items, {"study.toml", 4, 1}}; }

}  // namespace

TEST_CASE("a kind is made from its options and knows its canonical text") {
  const Made<Pet> pet = pets().make(table({{"kind", Value{std::string("cat"), {}}}, {"kilos", Value{5.5, {}}}}));

  CHECK(pet->weight() == 5.5);
  CHECK(pet.kind == "cat");
  CHECK(pet.canonical() == "cat(kilos = 5.5)");
  CHECK(pets().at("cat").make(table({})).canonical() == "cat(kilos = 4)");
}

TEST_CASE("an unknown, misspelt or missing kind is one clear error") {
  CHECK_THROWS_WITH_AS(pets().at("cta", {"study.toml", 2, 3}),
                       "study.toml:2:3: unknown pet 'cta'; did you mean 'cat'? (gust list pets)", Error);
  CHECK_THROWS_WITH_AS(pets().at("elephant"), "gust: unknown pet 'elephant' (gust list pets)", Error);
  CHECK_THROWS_WITH_AS(pets().make(table({})), "study.toml:4:1: a pet needs a 'kind': cat", Error);
  CHECK_THROWS_AS(pets().make(table({{"kind", Value{1.0, {}}}})), Error);
}

TEST_CASE("an entry tells what gust list and gust describe show") {
  const Entry<Pet>& entry = pets().entries().front();

  CHECK(pets().sort() == "pet");
  CHECK(pets().names() == std::vector<std::string>{"cat"});
  CHECK(entry.summary == "Sleeps.");
  CHECK(entry.source == "own");
  CHECK(entry.fields.front().unit == "kg");
}
