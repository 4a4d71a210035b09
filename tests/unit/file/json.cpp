// JSON documents: positions of mistakes, typed access.
#include <doctest/doctest.h>

#include <map>
#include <string>
#include <vector>

#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/file/json.hpp>

namespace ml = motionlang;

namespace {

const nlohmann::json document =
    ml::parse_json(R"({"model": {"width": 512, "rates": [0.5, 1], "name": "m", "big": 5000000000,
  "whole": 20.0, "half": 0.5, "on": true, "none": null, "negative": -3}, "layers": [{"heads": 4}, {"heads": "x"}],
  "weights": {"legs": 3, "head": 1}})");
const ml::JsonView view(document, "config.json");

std::string message_of(auto&& f) {
  try {
    f();
  } catch (const ml::error& e) {
    return e.what();
  }
  return "nothing thrown";
}

}  // namespace

TEST_CASE("a mistake is reported with line and column") {
  const auto at = [](std::string_view text) { return message_of([&] { ml::parse_json(text, "file"); }).substr(0, 35); };
  CHECK(at("{\"a\": 1,\n \"b\": x}").starts_with("[motionlang.io.403] file:2:7: "));
  CHECK(at("").starts_with("[motionlang.io.403] file:1:1: "));
  CHECK(at("[1,2").starts_with("[motionlang.io.403] file:1:"));
  CHECK(at("{}\n{}").starts_with("[motionlang.io.403] file:2:1: "));
  CHECK(at("[1,\n-1e999]").starts_with("[motionlang.io.403] file:2:1: a num"));
  CHECK(at("\"\xFF\"").starts_with("[motionlang.io.403] file:1:"));
}

TEST_CASE("the message says all that is wrong") {
  CHECK(message_of([] {
          ml::parse_json("[\"a: \nb\"]", "file");
        }).find("syntax error while parsing value - invalid string") != std::string::npos);
}

TEST_CASE("a duplicate name in an object is refused with both places") {
  const auto said = [](std::string_view text) { return message_of([&] { ml::parse_json(text, "file"); }); };
  CHECK(said("{\"a\": 1,\n \"b\": 2, \"a\": 3}") ==
        "[motionlang.io.403] file:2:10: the name 'a' is duplicated, first at 1:2");
  CHECK(said("[{\"x\": [{\"k\\\"\" : \"k:\", \"k\": {}}, {\"\\u006b\": 1,\n\"k\": 1}]}]") ==
        "[motionlang.io.403] file:2:1: the name 'k' is duplicated, first at 1:35");
  CHECK_NOTHROW(ml::parse_json("{\"a\": {\"a\": [{\"a\": 1}, {\"a\": \"a\"}]}}"));
}

TEST_CASE("nesting is limited") {
  CHECK_NOTHROW(ml::parse_json(std::string(200, '[') + std::string(200, ']')));
  CHECK_THROWS_WITH_AS(ml::parse_json(std::string(100'000, '[')), doctest::Contains("[motionlang.io.403]"),
                       ml::io_error);
}

TEST_CASE("values of the right kind") {
  const auto model = view["model"];
  CHECK(model["width"].as<int>() == 512);
  CHECK(model["width"].as<double>() == 512.0);
  CHECK(model["rates"].as<std::vector<double>>() == std::vector{0.5, 1.0});
  CHECK(model["name"].as<std::string>() == "m");
  CHECK(model["big"].as<ml::Index>() == 5'000'000'000);
  CHECK(model["whole"].as<int>() == 20);
  CHECK(model["negative"].as<int>() == -3);
  CHECK(model["on"].as<bool>());
  CHECK(view["layers"][0]["heads"].as<int>() == 4);
  CHECK(view["weights"].as<std::map<std::string, int>>() == std::map<std::string, int>{{"legs", 3}, {"head", 1}});
  CHECK(view["weights"].keys() == std::vector<std::string>{"head", "legs"});
  CHECK(model.value_or("width", 1) == 512);
  CHECK(model.value_or("missing", 1) == 1);
  CHECK(model.value_or("none", 2.5) == 2.5);
  CHECK(model.value_or("name", "other") == "m");
  CHECK(model.contains("none"));
  CHECK(model["none"].is_null());
}

TEST_CASE("values of the wrong kind name the way") {
  const auto model = view["model"];
  CHECK(message_of([&] { view["layers"][1]["heads"].as<int>(); }) ==
        "[motionlang.config.107] config.json: layers[1].heads: expected an integer, found string");
  CHECK(message_of([&] { model["rates"].as<std::vector<int>>(); }) ==
        "[motionlang.config.107] config.json: model.rates[0]: expected an integer, found number");
  for (const auto& wrong : std::vector<std::function<void()>>{
           [&] { model["missing"]; }, [&] { model["width"]["x"]; }, [&] { view["layers"][2]; },
           [&] { view["layers"][-1]; }, [&] { model[0]; }, [&] { model["half"].as<int>(); },
           [&] { model["big"].as<int>(); }, [&] { model["negative"].as<unsigned>(); }, [&] { model["on"].as<int>(); },
           [&] { model["width"].as<bool>(); }, [&] { model["width"].as<std::string>(); },
           [&] { model["name"].as<double>(); }, [&] { model["none"].as<double>(); }, [&] { model["width"].size(); },
           [&] { model["width"].keys(); }, [&] { model.value_or("name", 1); }}) {
    CHECK_MESSAGE(message_of(wrong).starts_with("[motionlang.config.107] config.json: "), message_of(wrong));
  }
}

TEST_CASE("a document as text: in one line or indented; what is not UTF-8 is replaced") {
  const nlohmann::ordered_json foreign{{"name", "a\xff"}, {"list", {1, 2}}};
  CHECK(ml::detail::json_text(foreign) == "{\"name\":\"a\xef\xbf\xbd\",\"list\":[1,2]}");
  CHECK(ml::detail::json_text(nlohmann::json{{"n", 1}}, 2) == "{\n  \"n\": 1\n}");
}
