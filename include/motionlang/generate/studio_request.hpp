// SPDX-License-Identifier: MIT
/// Requests to the server of the studio (generate/studio_server.hpp), without a network: who may ask, and what is
/// asked. Everything here may come from an enemy.
///
///     const StudioGate gate{.hosts = loopback_hosts(8421), .token = token};
///     if (const auto no = refusal(gate, head); no.status != 0) return answer(no.status, no.reason);
///     const StudioQuestion question = parse_studio_question(body);
#pragma once

#include <cstddef>      // limits
#include <cstdint>      // seeds
#include <optional>     // records
#include <string>       // fields
#include <string_view>  // JSON
#include <vector>       // files

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The head of a request. A field that it lacks is "".
struct StudioHead {
  std::string method, path;
  std::string host{}, origin{}, site{}, type{}, token{};  // Host, Origin, Sec-Fetch-Site, Content-Type, and the token
};

/// Who may ask.
struct StudioGate {
  std::vector<std::string> hosts;  // names with their port by which the server is reached, in letters of any size
  std::string token;               // in every question
};

/// The names of the own machine at a port: 127.0.0.1, localhost and [::1].
std::vector<std::string> loopback_hosts(int port);

/// A status of HTTP and a reason; 0 if a request is not refused.
struct StudioRefusal {
  int status = 0;
  std::string reason{};
};

/// The page ("GET /") is for everybody who names the server by one of its hosts, as a browser does unless a name of
/// somebody else leads here. The port 80 may be left out. A question ("POST /ask") also needs the token and JSON, and
/// never comes from a page of another origin. Everything else is refused. The time that it takes does not depend on the
/// token.
StudioRefusal refusal(const StudioGate& gate, const StudioHead& head);

struct StudioLimits {
  std::size_t question = 48u << 20;  // bytes of a question with a file in it
  std::size_t head = 64u << 10;      // bytes of the head of a request
  std::size_t file = 32u << 20;      // bytes of a file
  std::size_t text = 100000;         // bytes of a timeline or of a text
  double seconds = 120;              // of a motion
  Index offered = 50;                // texts, and moments that a search finds
  Index remembered = 500;            // moments of the latest searches of a client
  double read_seconds = 3600;        // of the motion of a file
  double head_seconds = 10;          // until the head of a request is here
  double question_seconds = 30;      // until all of a question is here
  double stalled_seconds = 60;       // that an answer waits, all in all, for somebody who does not read it
};

/// A stretch of a motion that is kept.
struct StudioClip {
  std::string id{}, parts{};  // parts "": all
  double from = 0, start = 0, end = 0;
};

/// A question of the page. Fields that a kind does not need have their defaults.
struct StudioQuestion {
  std::string kind{};    // load, check, known, generate, read, show, save, files, open, store, search, moment
  std::string client{};  // 32 hexadecimal digits that the page chose
  std::string timeline{}, begun{}, words{}, name{}, format{}, id{};
  std::vector<std::byte> bytes{};  // of a file
  std::uint64_t seed = 0;
  bool fast = false, has_character = false;
  Index count = 0, motion = 0;
  double beyond = 0;
  std::optional<Index> record{};
  std::optional<StudioClip> clip{};
  std::optional<std::string> over{};  // the mark of the contents that `store` may overwrite; without: all
};

/// Throws io_error 403 for anything but JSON, config_error 107 for a value of the wrong kind, 103 for an unknown kind
/// and a name that files may not have, 101 for what is beyond the limits.
StudioQuestion parse_studio_question(std::string_view json, const StudioLimits& limits = {});

/// True for names of files that no system reads as a path or as something special: letters, digits, '.', '_', '-' and
/// ' ' between them, 100 at most, with one of the endings that the studio reads or writes. Devices of Windows (nul,
/// com1) are none.
bool is_studio_file(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/studio_request.ipp>
#endif
