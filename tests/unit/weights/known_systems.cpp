// The table of systems.
#include <set>
#include <string_view>

#include <doctest/doctest.h>

#include <motionlang/weights/known_systems.hpp>

namespace {

namespace ml = motionlang;

TEST_CASE("systems are found by name, and no name stands for two") {
  std::set<std::string_view> names;
  for (const ml::KnownSystem& s : ml::known_systems()) {
    CHECK(names.insert(s.name).second);
    CHECK(ml::known_system(s.name) == &s);
    CHECK_FALSE(s.title.empty());
  }
  CHECK(ml::known_system("temos")->title == "TEMOS");
  CHECK(ml::known_system("") == nullptr);
  CHECK(ml::known_system("classifier") == nullptr);
}

TEST_CASE("a system has places for its weights, or looks like one that has") {
  for (const ml::KnownSystem& s : ml::known_systems()) {
    const ml::KnownSystem* const like = s.folder_of.empty() ? &s : ml::known_system(s.folder_of);
    REQUIRE(like != nullptr);
    CHECK(like->folder_of.empty());
    CHECK_FALSE(like->weights.front().ends.empty());
  }
}

TEST_CASE("STMC composes diffusion models of texts") {
  for (const char* name : {"stmc", "mdm", "motiondiffuse"}) CHECK(ml::is_diffusion_system(name));
  for (const char* name : {"actor", "temos", "tmr", "teach", "sinc", "tm2t", "mdm of actions", ""})
    CHECK_FALSE(ml::is_diffusion_system(name));
}

}  // namespace
