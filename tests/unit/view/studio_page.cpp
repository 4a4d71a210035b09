// The studio's page: its parts, its rules, and what it refuses. tests/browser uses it.
#include <motionlang/view/studio_page.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/json.hpp>
#include <motionlang/view/viewer.hpp>

#include "../../support/markup.hpp"
#include "../../support/page_data.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

std::span<const std::byte> bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

}  // namespace

TEST_CASE("one file with code and model in it, which asks for nothing and may run only that") {
  const std::string code = "code!", model = "the model";
  const ml::StudioParts parts{.program = "var motionlangModule; // </script>",
                              .code = bytes(code),
                              .model = bytes(model),
                              .prompts = {{"walk </script> forward", 4}, {"sit", 2}},
                              .title = "A <studio>"};
  const std::string page = ml::studio_html(parts);
  CHECK(page == ml::studio_html(parts));
  for (const char* word : {"http:", "https:", "src=", "@import", "url(", "import("})
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  CHECK(page.find("content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline' "
                  "'wasm-unsafe-eval'; worker-src blob:\"") != std::string::npos);
  CHECK(page.find("<title>A &lt;studio&gt;</title>") != std::string::npos);
  CHECK(occurrences(page, "</script>") == 4);  // of code, model, data and program
  CHECK(page.find("id=\"code\">" + ml::detail::seven_bit_text(parts.code) + "</script>") != std::string::npos);
  CHECK(page.find("id=\"model\">" + ml::detail::seven_bit_text(parts.model) + "</script>") != std::string::npos);
  const json data = data_of(page);
  CHECK(data["title"] == "A <studio>");
  CHECK(data["version"] == MOTIONLANG_VERSION);
  CHECK(data["prompts"] == json::parse(R"([{"text": "walk </script> forward", "seconds": 4.0},
                                           {"text": "sit", "seconds": 2.0}])"));
  CHECK(std::string(data["program"]).starts_with(parts.program));
  CHECK(std::string(data["program"]).find("onmessage") != std::string::npos);
  CHECK(data["rest"]["frames"] == 1);
  CHECK(data["rest"]["parents"].size() == 24);
}

TEST_CASE("with a model for searches the page has its two files") {
  const std::string part = "x", config = "{}", weights = "the weights";
  const std::string page = ml::studio_html({.program = part,
                                            .code = bytes(part),
                                            .model = bytes(part),
                                            .search_config = bytes(config),
                                            .search_weights = bytes(weights)});
  for (const auto& part_of_page : {std::pair{"searchConfig", config}, std::pair{"searchWeights", weights}}) {
    const std::string element =
        "id=\"" + std::string(part_of_page.first) + "\">" + ml::detail::seven_bit_text(bytes(part_of_page.second));
    CHECK_MESSAGE(page.find(element + "</script>") != std::string::npos, part_of_page.first);
  }
  CHECK(occurrences(page, "</script>") == 6);
}

TEST_CASE("a page that asks a server has no program, code and model, and asks nobody else") {
  const std::string page = ml::studio_html({.program = "", .code = {}, .model = {}, .asks_server = true});
  CHECK(page.find("script-src 'unsafe-inline'; connect-src 'self'\">") != std::string::npos);
  CHECK(page.find("http:") == std::string::npos);
  CHECK(occurrences(page, "</script>") == 2);  // of data and program
  CHECK_FALSE(data_of(page).contains("program"));
}

TEST_CASE("bytes are text with seven bits a character, without what a page would change") {
  std::string all;
  for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
  for (std::size_t length = 0; length <= all.size(); ++length) {
    const std::string text = ml::detail::seven_bit_text(bytes(all.substr(0, length)));
    CHECK(text.find_first_of(std::string("\0\r<", 3)) == text.npos);
    // as the page reads it
    std::string back;
    unsigned held = 0;
    int bits = 0;
    for (const char c : text) {
      if (static_cast<unsigned char>(c) == 0xC4) continue;  // the first byte of a character of two
      held = (held << 7 | (static_cast<unsigned>(c) & 127)) & 0x7fff;
      if ((bits += 7) >= 8) back += static_cast<char>(held >> (bits -= 8));
    }
    CHECK(back == all.substr(0, length));
  }
  CHECK(ml::detail::seven_bit_text(bytes(std::string(7, '\xff'))) == std::string(8, '\x7f'));
}

TEST_CASE("every button and field of the page has a name") {
  const std::string page = ml::studio_html({.program = "p", .code = bytes("c"), .model = bytes("m")});
  std::size_t count = 0;
  for (std::size_t at = 0; (at = page.find("<input id=", at)) != std::string::npos; ++at) {
    const std::string tag = page.substr(at, page.find('>', at) - at);
    const bool inside_label =
        page.rfind("<label>", at) != std::string::npos && page.find("</label>", page.rfind("<label>", at)) > at;
    CHECK_MESSAGE((inside_label || tag.find("aria-label=") != std::string::npos || tag.ends_with("hidden")), tag);
    ++count;
  }
  CHECK(count == 10);
}

TEST_CASE("a page without one of its parts is an error") {
  const std::string part = "x";
  CHECK_THROWS_WITH_AS(ml::studio_html({.program = "", .code = bytes(part), .model = bytes(part)}),
                       doctest::Contains("studio: no program"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::studio_html({.program = part, .code = {}, .model = bytes(part)}),
                       doctest::Contains("studio: no code"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::studio_html({.program = part, .code = bytes(part), .model = {}}),
                       doctest::Contains("studio: no model"), ml::config_error);
}

TEST_CASE("the data of one motion are those in its viewer's page") {
  const ml::Motion walk = synthetic::walk({.frames = 12});
  CHECK(json::parse(ml::viewer_data(walk)) == data_of(ml::viewer_html(walk))["motions"][0]);
  ml::Motion empty = walk;
  empty.root.clear(), empty.local.clear();
  CHECK_THROWS_AS(ml::viewer_data(empty), ml::config_error);
}
