// Hyperparameters from and to JSON: every error gives the path of the field.
#include <doctest/doctest.h>

#include <motionlang/core/require_value.hpp>
#include <motionlang/file/fields_json.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

struct Inner {
  double rate = 0.5;
  std::vector<ml::Index> sizes{1, 2};

  void require_sound() const { ml::require_value("rate", rate, rate >= 0, "0 or more"); }
  static constexpr auto fields() { return motionlang::fields("rate", &Inner::rate, "sizes", &Inner::sizes); }
};
struct Outer {
  std::string name = "x";
  bool fast = false;
  Inner inner;

  static constexpr auto fields() {
    return motionlang::fields("name", &Outer::name, "fast", &Outer::fast, "inner", &Outer::inner);
  }
};

}  // namespace

TEST_CASE("a configuration becomes JSON in the order of its fields and comes back") {
  Outer c;
  c.name = "y", c.inner.rate = 0.25, c.inner.sizes = {3};
  const auto document = ml::config_json(c);
  CHECK(document.dump() == R"({"name":"y","fast":false,"inner":{"rate":0.25,"sizes":[3]}})");
  Outer back;
  const nlohmann::json read = document;
  ml::read_config(back, ml::JsonView(read, "c.json"));
  CHECK(ml::config_json(back) == document);
}

TEST_CASE("members that a document lacks stay as they are") {
  Outer c;
  c.name = "kept";
  const auto document = ml::parse_json(R"({"inner": {"rate": 1}})");
  ml::read_config(c, ml::JsonView(document, "c.json"));
  CHECK(c.name == "kept");
  CHECK(c.inner.rate == 1);
  CHECK(c.inner.sizes == std::vector<ml::Index>{1, 2});
}

TEST_CASE("one field is set by its path; what is not JSON is a text") {
  Outer c;
  ml::set_config(c, "inner.rate=1e-3");
  ml::set_config(c, "inner.sizes=[4,5]");
  ml::set_config(c, "name=word");
  ml::set_config(c, "fast=true");
  CHECK(c.inner.rate == 1e-3);
  CHECK(c.inner.sizes == std::vector<ml::Index>{4, 5});
  CHECK(c.name == "word");
  CHECK(c.fast);
  const auto texts = ml::config_texts(c);
  CHECK(texts.at("inner.rate") == "0.001");
  CHECK(texts.at("inner.sizes.1") == "5");
  CHECK(texts.at("name") == "word");
  CHECK(texts.size() == 5);
}

TEST_CASE("errors give the path") {
  Outer c;
  const auto read = [&](const char* text) {
    const auto document = ml::parse_json(text);
    ml::read_config(c, ml::JsonView(document, "c.json"));
  };
  CHECK_ERROR(read(R"({"inner": {"rat": 1}})"),
              "[motionlang.config.103] c.json: inner: has no member 'rat'; did you mean 'rate'?");
  CHECK_ERROR(read(R"({"zzzzzz": 1})"), "c.json: has no member 'zzzzzz'; there are name, fast, inner");
  CHECK_ERROR(read(R"({"inner": {"rate": "much"}})"), "[motionlang.config.107] c.json: inner.rate");
  CHECK_ERROR(read(R"({"inner": {"rate": -1}})"),
              "[motionlang.config.101] c.json: inner: rate is -1, expected 0 or more");
  CHECK_ERROR(ml::set_config(c, "inner.rate"), "[motionlang.config.103] inner.rate: expected name=value");
  CHECK_ERROR(ml::set_config(c, "inner.rate=-2", "--set inner.rate=-2"),
              "[motionlang.config.101] --set inner.rate=-2: inner: rate is -2, expected 0 or more");
}
