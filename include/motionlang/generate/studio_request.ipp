// SPDX-License-Identifier: MIT
// Bodies of studio_request.hpp.
#pragma once

#include <algorithm>         // all_of, find, find_if
#include <initializer_list>  // words

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/generate/studio_request.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}
inline std::string in_small_letters(std::string text) {
  for (char& c : text) c = lower(c);
  return text;
}
/// Compares all characters, whichever differ.
inline bool is_secret(std::string_view given, std::string_view secret) {
  unsigned differs = given.size() == secret.size() && !secret.empty() ? 0u : 1u;
  for (std::size_t i = 0; i < secret.size(); ++i)
    differs |= static_cast<unsigned char>(secret[i]) ^ static_cast<unsigned char>(i < given.size() ? given[i] : '\0');
  return differs == 0;
}
/// True for a name of the host, which browsers write without the port of HTTP, 80.
inline bool names_host(std::string_view name, std::string_view host) {
  return name == host || (host.ends_with(":80") && name == host.substr(0, host.size() - 3));
}
/// True for a name that Windows reads as a device, whatever its ending.
inline bool is_device(std::string_view name) {
  std::string_view word = name.substr(0, name.find('.'));
  word = word.substr(0, word.find_last_not_of(' ') + 1);
  const std::string small = in_small_letters(std::string(word));
  if (small.size() == 4 && small[3] >= '0' && small[3] <= '9') return is_one_of(small.substr(0, 3), {"com", "lpt"});
  return is_one_of(small, {"con", "prn", "aux", "nul"});
}
inline bool is_client(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == 32 && std::all_of(text.begin(), text.end(), is_digit);
}

/// Reads the members of a question, within the limits.
class StudioFields {
 public:
  StudioFields(const JsonView& view, const StudioLimits& limits) : view_(view), limits_(limits) {}

  std::string text(const std::string& key) const {
    std::string out = view_.value_or(key, "");
    if (out.size() > limits_.text) fail(key);
    return out;
  }
  double number(const std::string& key, double most) const {
    const double out = view_.value_or(key, 0.0);
    if (!(out >= 0 && out <= most)) fail(key);
    return out;
  }
  Index index(const std::string& key, Index most) const {
    const Index out = view_.value_or(key, Index{0});
    if (out < 0 || out > most) fail(key);
    return out;
  }
  std::vector<std::byte> bytes(const std::string& key) const {
    const std::string packed = view_.value_or(key, "");
    if (packed.size() / 4 * 3 > limits_.file) fail(key);
    return from_base64(packed, key);
  }

 private:
  [[noreturn]] void fail(const std::string& key) const {
    raise<config_error>(101, view_.path(), ".", key, " is too large, or below 0");
  }
  const JsonView& view_;
  const StudioLimits& limits_;
};

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> loopback_hosts(int port) {
  std::vector<std::string> out;
  for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) out.push_back(concat_text(name, ":", port));
  return out;
}

MOTIONLANG_BODY StudioRefusal refusal(const StudioGate& gate, const StudioHead& head) {
  const std::string name = detail::in_small_letters(head.host), origin = detail::in_small_letters(head.origin);
  const auto host = std::find_if(gate.hosts.begin(), gate.hosts.end(), [&](const std::string& known) {
    return detail::names_host(name, detail::in_small_letters(known));
  });
  if (host == gate.hosts.end()) return {421, "this server has another name\n"};
  const std::string http = "http://";
  if (!origin.empty() && !detail::names_host(origin, http + detail::in_small_letters(*host)))
    return {403, "pages of other origins may not ask\n"};
  if (!detail::is_one_of(head.site, {"", "same-origin", "none"})) return {403, "pages of other sites may not ask\n"};
  if (head.path == "/") {
    if (head.method == "GET" || head.method == "HEAD") return {};
    return {405, "GET gives the page\n"};
  }
  if (head.path != "/ask") return {404, "there is nothing here\n"};
  if (head.method != "POST") return {405, "questions come by POST\n"};
  if (!detail::is_secret(head.token, gate.token)) return {401, "the link of the program has a token: open that\n"};
  const std::string type = detail::in_small_letters(head.type.substr(0, head.type.find(';')));
  if (type != "application/json") return {415, "questions are application/json\n"};
  return {};
}

MOTIONLANG_BODY bool is_studio_file(std::string_view name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  const std::size_t dot = name.rfind('.');
  if (dot == name.npos || dot == 0 || name.size() > 100 || !is_plain(name.front()) || !is_plain(name[dot - 1]) ||
      detail::is_device(name))
    return false;
  if (!detail::is_one_of(name.substr(dot), {".txt", ".bvh", ".glb", ".gltf", ".vrm", ".vrma", ".npz", ".npy", ".html",
                                            ".svg", ".json", ".png", ".gif", ".webm", ".mp4"}))
    return false;
  return std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(c) || c == '.' || c == ' '; });
}

MOTIONLANG_BODY StudioQuestion parse_studio_question(std::string_view json, const StudioLimits& limits) {
  if (json.size() > limits.question) raise<config_error>(101, "question: ", counted(json.size(), "byte"));
  const nlohmann::json document = parse_json(json, "question");
  const JsonView view(document, "question");
  if (!view.is_object()) raise<config_error>(107, "question: not an object");
  const detail::StudioFields fields(view, limits);
  constexpr Index many = 1'000'000'000;
  StudioQuestion out{.kind = fields.text("kind"),
                     .client = fields.text("client"),
                     .timeline = fields.text("timeline"),
                     .begun = fields.text("begun"),
                     .words = fields.text("words"),
                     .name = fields.text("name"),
                     .format = fields.text("format"),
                     .id = fields.text("id"),
                     .bytes = fields.bytes("bytes"),
                     .seed = view.value_or("seed", std::uint64_t{0}),
                     .fast = view.value_or("fast", false),
                     .count = fields.index("count", limits.offered),
                     .motion = fields.index("motion", many),
                     .beyond = fields.number("beyond", limits.seconds)};
  if (!detail::is_one_of(out.kind, {"load", "check", "known", "generate", "read", "show", "save", "files", "open",
                                    "store", "search", "moment"}))
    raise<config_error>(103, "question.kind: '", out.kind, "'");
  if (!detail::is_client(out.client)) raise<config_error>(103, "question.client: not 32 hexadecimal digits");
  if (!out.name.empty() && !is_studio_file(out.name)) raise<config_error>(103, "question.name: '", out.name, "'");
  const auto given = [&](const char* key) { return view.contains(key) && !view[key].is_null(); };
  for (const char* part : {"character", "clip"}) {
    if (given(part) && !view[part].is_object()) raise<config_error>(107, "question.", part, ": not an object");
  }
  if (given("record")) out.record = fields.index("record", many);
  if (given("over")) out.over = fields.text("over");
  if (given("character")) {
    const JsonView character = view["character"];
    const detail::StudioFields of(character, limits);
    out.has_character = true;
    out.name = of.text("name");
    out.bytes = of.bytes("bytes");
    if (!is_studio_file(out.name)) raise<config_error>(103, "question.character.name: '", out.name, "'");
  }
  if (given("clip")) {
    const JsonView clip = view["clip"];
    const detail::StudioFields of(clip, limits);
    constexpr double hour = 3600;  // of a file's motion
    out.clip = StudioClip{.id = of.text("id"),
                          .parts = of.text("parts"),
                          .from = of.number("from", hour),
                          .start = of.number("start", limits.seconds),
                          .end = of.number("end", limits.seconds)};
    if (!(out.clip->end >= out.clip->start)) raise<config_error>(101, "question.clip ends before it begins");
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
