// SPDX-License-Identifier: MIT
/// The studio (view/studio_page.hpp) at native speed and with any model: answers the questions of its pages. It knows
/// no network; the program `motionlang studio` connects it to one, behind the checks of generate/studio_request.hpp.
///
///     StudioServer server(std::move(model), {.project = "my project"});
///     send(server.page());
///     server.answer(body, [&](std::string_view line) { return send(line); });
///
/// Threads  any number may ask at the same time. Motions and files of one client are not those of another.
#pragma once

#include <cstdint>      // random numbers
#include <filesystem>   // the project
#include <functional>   // writers, the model of searches
#include <memory>       // the model
#include <string>       // the page
#include <string_view>  // lines

#include <motionlang/generate/motion_model.hpp>
#include <motionlang/generate/studio_request.hpp>
#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct StudioServerOptions {
  StudioLimits limits{};
  double generation_seconds = 600;  // the longest time of one generation
  Index together = 2;               // motions that are made, read, drawn or saved at the same time
  Index waiting = 16;               // questions that wait for that
  Index clients = 16;               // the longest silent ones are forgotten
  Index motions = 12;               // of each client; the oldest are forgotten
  Index files = 4;                  // of each client
  std::filesystem::path project{};  // folder whose files the pages may read and write; "": none
  std::filesystem::path scratch{};  // folder for records of motions, which only this server uses; "": nothing is reused
  /// Loads the model of searches in the project, when somebody first searches. Empty: nobody can search.
  std::function<std::shared_ptr<const SearchEncoder>()> search_model{};
  std::string title = "motionlang studio";
};

/// Takes a line of an answer. False: nobody listens any longer, so the work stops.
using StudioWriter = std::function<bool(std::string_view)>;

class StudioServer {
 public:
  /// Throws io_error 401 without the folder of the project, config_error 101 without a model.
  StudioServer(std::shared_ptr<const MotionModel> model, StudioServerOptions options = {});
  ~StudioServer();
  StudioServer(const StudioServer&) = delete;
  StudioServer& operator=(const StudioServer&) = delete;

  /// The page, which asks this server. The same text every time.
  const std::string& page() const;
  /// Answers with lines of JSON: {"done", "total"} after every step, {"waiting": true} while others are served, and at
  /// the end {"value"} or {"error"}. Throws nothing that a question causes.
  void answer(std::string_view question, const StudioWriter& write);
  const StudioLimits& limits() const;

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/studio_server.ipp>
#endif
