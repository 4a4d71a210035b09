// Errors: ids, families, messages.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <motionlang/core/shape.hpp>

namespace ml = motionlang;

namespace {

template <class E>
std::string family_of(int id) {
  try {
    ml::raise<E>(id, "text");
  } catch (const E& e) {
    CHECK(e.id() == id);
    return e.what();
  }
  return "not thrown";
}

}  // namespace

TEST_CASE("ids are unique, ascending, and each has a meaning") {
  int last = 0;
  std::set<std::string_view> meanings;
  for (const ml::ErrorId& e : ml::error_ids) {
    CHECK(e.id > last);
    CHECK(e.id / 100 >= 1);
    CHECK(e.id / 100 <= 5);
    CHECK_FALSE(e.meaning.empty());
    CHECK_MESSAGE(meanings.insert(e.meaning).second, e.meaning);
    last = e.id;
  }
}

TEST_CASE("lists: what stands between, and how an item is written") {
  CHECK(ml::join_text(std::vector<std::string>{}) == "");
  CHECK(ml::join_text(std::vector<std::string>{"", "b"}) == ", b");
  CHECK(ml::join_text(std::vector<int>{1, 2, 3}, ";") == "1;2;3");
  CHECK(ml::join_text(std::vector<ml::Shape>{{1}, {2, 3}}, " or ") == "(1) or (2, 3)");
  CHECK(ml::join_text(std::vector<int>{1, 2}, ", ", [](int n) { return ml::concat_text("no. ", n); }) ==
        "no. 1, no. 2");
}

TEST_CASE("a message begins with family and id") {
  CHECK(family_of<ml::config_error>(101) == "[motionlang.config.101] text");
  CHECK(family_of<ml::shape_error>(201) == "[motionlang.shape.201] text");
  CHECK(family_of<ml::numeric_error>(301) == "[motionlang.numeric.301] text");
  CHECK(family_of<ml::io_error>(401) == "[motionlang.io.401] text");
  CHECK(family_of<ml::timeline_error>(501) == "[motionlang.timeline.501] text");
}

TEST_CASE("every error is a motionlang error and a runtime error; a cancellation is not an error") {
  CHECK_THROWS_AS(ml::raise<ml::io_error>(401, "x"), ml::error);
  CHECK_THROWS_AS(ml::raise<ml::io_error>(401, "x"), std::runtime_error);
  static_assert(!std::is_base_of_v<ml::error, ml::cancelled>);
}

TEST_CASE("values of all kinds are written without the locale") {
  CHECK(ml::concat_text("a", 'b', std::string("c"), std::string_view("d")) == "abcd");
  CHECK(ml::concat_text(-3, " ", 18446744073709551615u, " ", true, false) == "-3 18446744073709551615 truefalse");
  CHECK(ml::concat_text(0.1, " ", 1e300, " ", 2.5f) == "0.1 1e+300 2.5");
  CHECK(ml::concat_text(1e7, " ", -2e15, " ", 1e5f, " ", 3e9f, " ", -0.0) ==
        "10000000 -2000000000000000 100000 3e+09 -0");
  CHECK(ml::concat_text(std::nan(""), " ", -std::numeric_limits<float>::infinity()) == "nan -inf");
  CHECK(ml::concat_text(ml::Shape{2, 60, 512}, ml::Shape{}) == "(2, 60, 512)()");
  CHECK(ml::concat_text() == "");
}

TEST_CASE("numbers of things: one and several") {
  CHECK(ml::counted(0, "frame") == "0 frames");
  CHECK(ml::counted(1, "frame") == "1 frame");
  CHECK(ml::counted(std::size_t{2}, "frame") == "2 frames");
  CHECK(ml::counted(1, "pass", "passes") == "1 pass");
  CHECK(ml::counted(3, "pass", "passes") == "3 passes");
}

TEST_CASE("module paths are part of the message when diagnostics are on") {
  std::string message;
  try {
    const ml::ModuleScope outer("layers.", 3);
    const ml::ModuleScope inner("linear1");
    ml::raise<ml::shape_error>(201, "text");
  } catch (const ml::error& e) {
    message = e.what();
  }
#ifdef MOTIONLANG_DIAGNOSTICS
  CHECK(message == "[motionlang.shape.201] text; at layers.3.linear1");
#else
  CHECK(message == "[motionlang.shape.201] text");
#endif
  CHECK(family_of<ml::shape_error>(201) == "[motionlang.shape.201] text");  // the scopes are closed again
}
