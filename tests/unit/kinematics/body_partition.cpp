// The parts of a body as a value: names, the path, limits, what is refused.
#include <string>
#include <vector>

#include <motionlang/kinematics/body_partition.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::BodyPart, ml::BodyParts, ml::BodyPartition;

namespace {

ml::BodyPartNames dog() {
  return {.names = {"front left", "front right", "hind left", "hind right", "trunk"},
          .path = "trunk",
          .synonyms = {{"tail", "trunk"}, {"left paw", "front left"}},
          .words = {{"dig", {"front left", "front right"}}}};
}

}  // namespace

TEST_CASE("the default is the human body of STMC") {
  const BodyPartition human;
  CHECK(human.size() == ml::body_part_count);
  for (int p = 0; p < human.size(); ++p) {
    const std::string& name = human.name(BodyPart{p});
    CHECK(name == ml::to_string(BodyPart{p}));
    CHECK(human.find(name) == ml::parse_body_part(name));
  }
  for (const auto& [synonym, part] : ml::body_part_synonyms) CHECK(human.find(synonym) == part);
  CHECK_FALSE(human.find("tail").has_value());
  CHECK(human.path() == BodyPart::legs);
  CHECK(human.all() == BodyParts::all());
  CHECK(human.words().empty());
  CHECK(ml::to_string(human) == "left arm, right arm, legs (with the path), head, spine");
}

TEST_CASE("an own body") {
  const BodyPartition body(dog());
  CHECK(body.size() == 5);
  CHECK(body.name(BodyPart{1}) == "front right");
  CHECK(body.path() == BodyPart{4});
  CHECK(body.all().bits == 31);
  CHECK(body.find("hind right") == BodyPart{3});
  CHECK(body.find("tail") == BodyPart{4});
  CHECK_FALSE(body.find("Tail").has_value());
  CHECK_FALSE(body.find("legs").has_value());
  CHECK(body.parts({"left paw", "trunk"}) == BodyParts{}.with(BodyPart{0}).with(BodyPart{4}));
  CHECK(body.parts({}).empty());
  REQUIRE(body.words().size() == 1);
  CHECK(body.words()[0].parts.bits == 3);
  CHECK_ERROR(
      body.parts({"trunk", "arm"}),
      "[motionlang.config.103] BodyPartition: 'arm' is not one of front left, front right, hind left, hind right, "
      "trunk");
  CHECK_ERROR(body.name(BodyPart{5}), "[motionlang.config.101] BodyPartition: part 5 of a body of 5 parts");
  CHECK_ERROR(body.name(BodyPart{-1}), "[motionlang.config.101]");
  CHECK(ml::to_string(BodyPart{7}) == "part 7");
}

TEST_CASE("bodies are equal if their names and the path are") {
  const BodyPartition body(dog());
  auto other = dog();
  other.synonyms.clear(), other.words.clear();
  CHECK(BodyPartition(other) == body);
  other.path = "hind left";
  CHECK(BodyPartition(other) != body);
  other = dog();
  std::swap(other.names[0], other.names[1]);
  CHECK(BodyPartition(other) != body);
  CHECK(body != BodyPartition());
  CHECK(BodyPartition({.names = {"left arm", "right arm", "legs", "head", "spine"}, .path = "legs"}) ==
        BodyPartition());
  const BodyPartition copy = body;
  CHECK(copy == body);
}

TEST_CASE("a body has 1 to 32 parts") {
  ml::BodyPartNames names{.names = {}, .path = "0"};
  CHECK_ERROR(BodyPartition{names}, "[motionlang.config.101] BodyPartition: 0 parts, expected 1 to 32");
  for (int p = 0; p < 32; ++p) names.names.push_back(std::to_string(p));
  const BodyPartition most(names);
  CHECK(most.size() == 32);
  CHECK(most.all() == BodyParts::every());
  CHECK(most.all().count() == 32);
  CHECK(most.all().has(BodyPart{31}));
  CHECK(BodyParts{}.with(BodyPart{31}).bits == 0x80000000u);
  names.names.emplace_back("32");
  CHECK_ERROR(BodyPartition{names}, "[motionlang.config.101] BodyPartition: 33 parts, expected 1 to 32");
  CHECK(BodyPartition({.names = {"arm"}, .path = "arm"}).all().bits == 1);
}

TEST_CASE("names that a timeline cannot hold, or that mean two parts or none, are refused") {
  for (const char* bad : {"", " arm", "arm ", "left # arm", "left\narm", "left\rarm", "\xFF"}) {
    CHECK_ERROR(BodyPartition({.names = {"base", bad}, .path = "base"}), "[motionlang.config.101] BodyPartition: '");
    CHECK_ERROR(BodyPartition({.names = {"base"}, .path = "base", .synonyms = {{bad, "base"}}}),
                "[motionlang.config.101] BodyPartition: '");
  }
  CHECK_ERROR(BodyPartition({.names = {"base", "arm", "base"}, .path = "base"}),
              "[motionlang.config.102] BodyPartition: 'base' is the name of two body parts");
  CHECK_ERROR(BodyPartition({.names = {"base", "arm"}, .path = "base", .synonyms = {{"arm", "base"}}}),
              "[motionlang.config.102]");
  CHECK_ERROR(BodyPartition({.names = {"base"}, .path = "base", .synonyms = {{"foot", "base"}, {"foot", "base"}}}),
              "[motionlang.config.102]");
  CHECK_ERROR(BodyPartition({.names = {"base", "arm"}, .path = "legs"}),
              "[motionlang.config.103] BodyPartition: 'legs' is not one of base, arm");
  CHECK_ERROR(BodyPartition({.names = {"base", "arm"}, .path = ""}), "[motionlang.config.103]");
  CHECK_ERROR(BodyPartition({.names = {"base"}, .path = "base", .synonyms = {{"hand", "arm"}}}),
              "[motionlang.config.103] BodyPartition: 'arm' is not one of base");
  CHECK_ERROR(BodyPartition({.names = {"base"}, .path = "base", .words = {{"grip", {"arm"}}}}),
              "[motionlang.config.103] BodyPartition: 'arm' is not one of base");
  for (const char* word : {"", "Grip", "grip it"}) {
    CHECK_ERROR(BodyPartition({.names = {"base"}, .path = "base", .words = {{word, {"base"}}}}),
                "[motionlang.config.101] BodyPartition: the word '");
  }
}
