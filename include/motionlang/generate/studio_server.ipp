// SPDX-License-Identifier: MIT
// Bodies of studio_server.hpp.
#pragma once

#include <algorithm>           // find, min_element
#include <array>               // kinds of files
#include <chrono>              // time limits
#include <condition_variable>  // turns
#include <list>                // motions, the oldest first
#include <map>                 // clients
#include <mutex>               // clients
#include <optional>            // folders
#include <utility>             // exchange

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/formatted.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/file/project_folder.hpp>
#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/generate/kept_clip_text.hpp>
#include <motionlang/generate/studio_server.hpp>
#include <motionlang/generate/timeline_report.hpp>
#include <motionlang/search/searched_folder.hpp>
#include <motionlang/view/rig_viewer.hpp>
#include <motionlang/view/studio_page.hpp>
#include <motionlang/view/view_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The motions and files of one client.
struct StudioClient {
  struct Made {
    Index number = 0;
    std::shared_ptr<const Motion> motion;
    std::filesystem::path record;
  };
  std::mutex mutex;
  std::list<Made> motions;
  std::list<std::pair<std::string, std::shared_ptr<const Motion>>> files;
  std::map<Index, FolderMoment> found;  // by latest searches
  std::uint64_t asked = 0;              // when it asked last
  ~StudioClient() {
    for (const Made& m : motions) forget(m);
  }
  static void forget(const Made& m) {
    std::error_code failed;
    if (!m.record.empty()) std::filesystem::remove(m.record, failed);
  }
};

/// A few questions have their turn at the same time; others wait.
class StudioTurns {
 public:
  StudioTurns(Index together, Index waiting) : free_(together), room_(waiting) {}
  /// False if too many wait, or if `still` says no.
  template <class F>
  bool wait(const F& still) {
    std::unique_lock lock(mutex_);
    if (free_ <= 0 && waiting_ >= room_) return false;
    ++waiting_;
    while (free_ <= 0) {
      freed_.wait_for(lock, std::chrono::milliseconds(500));
      if (free_ > 0) break;
      lock.unlock();
      const bool goes_on = still();
      lock.lock();
      if (!goes_on) return --waiting_, false;
    }
    --waiting_, --free_;
    return true;
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    ++free_;
    freed_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable freed_;
  Index free_, room_, waiting_ = 0;
};

}  // namespace detail

class StudioServer::Body {
 public:
  Body(std::shared_ptr<const MotionModel> model, StudioServerOptions options)
      : model_(std::move(model)), o_(std::move(options)), turns_(o_.together, o_.waiting), searches_(1, o_.waiting) {
    if (!model_) raise<config_error>(101, "studio: no model");
    if (!o_.project.empty()) folder_.emplace(o_.project, is_studio_file);
    StudioParts parts{.program = "", .code = {}, .model = {}, .title = o_.title, .asks_server = true};
    for (const KnownText& t : known_texts(model_->captions(), "", offered_at_first))
      parts.prompts.push_back({t.text, t.action.seconds});
    page_ = studio_html(parts);
  }

  const std::string& page() const { return page_; }
  const StudioServerOptions& options() const { return o_; }

  std::string value(std::string_view json, const StudioWriter& write) {
    const StudioQuestion q = parse_studio_question(json, o_.limits);
    if (q.kind == "load") return loaded();
    if (q.kind == "check") return timeline_report(*model_, q.timeline);
    if (q.kind == "known") return known_texts_report(known_texts(model_->captions(), q.begun, q.count));
    if (q.kind == "files") return text_of(nlohmann::ordered_json(folder().names()));
    if (q.kind == "open") return opened(q.name);
    if (q.kind == "store") return stored(q);
    const auto client = client_of(q.client);
    if (q.kind == "generate") return generated(q, *client, write);
    if (q.kind == "search") return found(q, *client, write);
    const Turn turn = turn_for(turns_, write);
    if (q.kind == "read") return read(q, *client);
    if (q.kind == "moment") return moment(q, *client);
    if (q.kind == "show") return rig_viewer_data(GlbRig(q.bytes, q.name), *motion_of(*client, q.motion).motion);
    return saved(q, *client);
  }

 private:
  static constexpr Index offered_at_first = 200;

  using Turn = std::unique_ptr<detail::StudioTurns, void (*)(detail::StudioTurns*)>;
  /// Waits for a turn, which ends with its answer.
  static Turn turn_for(detail::StudioTurns& turns, const StudioWriter& write) {
    if (!turns.wait([&] { return write("{\"waiting\":true}\n"); }))
      raise<config_error>(101, "too many questions wait at the moment");
    return {&turns, [](detail::StudioTurns* t) { t->leave(); }};
  }
  /// Says that steps are done, as long as somebody listens and the time of one generation is not over.
  auto steps_to(const StudioWriter& write) const {
    return [&write, began = std::chrono::steady_clock::now(), most = o_.generation_seconds](Index done, Index total) {
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - began;
      return taken.count() <= most && write(concat_text("{\"done\":", done, ",\"total\":", total, "}\n"));
    };
  }

  static std::string text_of(const nlohmann::ordered_json& json) { return detail::json_text(json); }
  static std::string packed(std::span<const std::byte> bytes) { return detail::to_base64(bytes); }

  const ProjectFolder& folder() const {
    if (!folder_) raise<config_error>(101, "this server has no folder for projects");
    return *folder_;
  }
  std::string opened(const std::string& name) const {
    const std::string contents = folder().read(name, o_.limits.file);
    const auto bytes = std::as_bytes(std::span(contents));
    return text_of({{"bytes", packed(bytes)}, {"mark", ProjectFolder::mark(bytes)}});
  }
  /// Says the mark of what is stored; null if somebody else's contents are there.
  std::string stored(const StudioQuestion& q) {
    const std::lock_guard lock(writes_);
    if (!q.over)
      folder().write(q.name, q.bytes);
    else if (!folder().write_over(q.name, q.bytes, *q.over, o_.limits.file))
      return "{\"mark\":null}";
    return text_of({{"mark", ProjectFolder::mark(q.bytes)}});
  }

  std::string loaded() const {
    return text_of({{"fps", model_->fps()},
                    {"system", model_->system()},
                    {"steps", model_->steps()},
                    {"folder", folder_.has_value()},
                    {"search", searches()},
                    {"timelines", model_->takes_timelines()}});
  }

  std::shared_ptr<detail::StudioClient> client_of(const std::string& name) {
    const std::lock_guard lock(mutex_);
    auto& client = clients_[name];
    if (!client) client = std::make_shared<detail::StudioClient>();
    client->asked = ++questions_;
    auto out = client;
    if (std::ssize(clients_) > o_.clients)  // who asks at this moment keeps its own until it is answered
      clients_.erase(std::min_element(clients_.begin(), clients_.end(),
                                      [](const auto& a, const auto& b) { return a.second->asked < b.second->asked; }));
    return out;
  }
  static detail::StudioClient::Made motion_of(detail::StudioClient& client, Index number) {
    const std::lock_guard lock(client.mutex);
    for (const auto& m : client.motions) {
      if (m.number == number) return m;
    }
    raise<config_error>(101, "this motion is gone");
  }

  std::string read(const StudioQuestion& q, detail::StudioClient& client) const {
    if (!is_one_of_readable(q.name))
      raise<config_error>(103, "'", q.name,
                          "': the studio reads motions in .bvh, .glb, .gltf, .vrm, .vrma, .npz and .npy");
    std::string notes;
    auto motions = parse_motions(q.bytes, q.name, {}, &notes);
    const auto motion = std::make_shared<const Motion>(std::move(motions.front()));
    if (!(motion->seconds() <= o_.limits.read_seconds))
      raise<config_error>(101, q.name, ": a motion of ", motion->seconds(), " s; this server reads at most ",
                          o_.limits.read_seconds);
    const std::lock_guard lock(client.mutex);
    client.files.remove_if([&](const auto& f) { return f.first == q.id; });
    client.files.emplace_back(q.id, motion);
    if (std::ssize(client.files) > o_.files) client.files.pop_front();
    return text_of({{"seconds", motion->seconds()}, {"notes", notes}});
  }
  static bool is_one_of_readable(const std::string& name) {
    constexpr std::array<std::string_view, 7> kinds{".bvh", ".glb", ".gltf", ".vrm", ".vrma", ".npz", ".npy"};
    return std::find(kinds.begin(), kinds.end(), file_kind(name)) != kinds.end();
  }

  /// The motion that is kept, with its first frame at its time.
  KeptClip kept(const StudioClip& clip, detail::StudioClient& client) const {
    std::shared_ptr<const Motion> whole;
    {
      const std::lock_guard lock(client.mutex);
      for (const auto& [id, motion] : client.files) {
        if (id == clip.id) whole = motion;
      }
    }
    if (!whole) raise<config_error>(101, "the file of the kept motion is gone");
    const double to = clip.from + clip.end - clip.start;
    KeptClip out{.motion = kept_part(*whole, clip.from, to, clip.start), .seconds = {{clip.start, clip.end}}};
    if (!clip.parts.empty()) out.parts = parse_kept_parts(clip.parts);
    return out;
  }

  /// The file for the record of a motion; "" for a model or a motion without one.
  std::filesystem::path record_of(Index number, const GenerateOptions& how) const {
    if (o_.scratch.empty() || !model_->takes_timelines() || how.keep) return {};
    return o_.scratch / concat_text("motion", number, ".safetensors");
  }

  std::string generated(const StudioQuestion& q, detail::StudioClient& client, const StudioWriter& write) {
    const Timeline timeline = parse_timeline(q.timeline, {.fps = model_->fps(), .name = "timeline"});
    const double seconds = static_cast<double>(timeline.end()) / model_->fps();
    if (!(seconds <= o_.limits.seconds))
      raise<config_error>(101, "a motion of ", seconds, " s; this server makes at most ", o_.limits.seconds);
    GenerateNotes notes;
    GenerateOptions how{.seed = q.seed};
    how.notes = &notes;
    if (q.clip) how.keep = kept(*q.clip, client);
    if (q.record && !how.keep) how.reuse = motion_of(client, *q.record).record;
    if (q.record && how.reuse.string().empty() && !how.keep) raise<config_error>(101, "this motion is gone");
    const bool reuses = !how.reuse.string().empty();
    if (reuses && q.beyond > 0) how.keep_beyond = q.beyond;
    if (q.fast && !reuses && model_->steps() >= fast_steps) use_fast_preset(how);

    const Turn turn = turn_for(turns_, write);
    const auto progress = steps_to(write);
    how.progress = progress;
    detail::StudioClient::Made made{.number = next(), .motion = {}, .record = {}};
    made.record = record_of(made.number, how);
    how.record = made.record;
    made.motion = std::make_shared<const Motion>(generate_motion(*model_, timeline, how));
    nlohmann::ordered_json reuse;
    if (const auto& r = notes.reuse) {
      const double work = r->whole_work == 0 ? 0 : static_cast<double>(r->work) / static_cast<double>(r->whole_work);
      reuse = {{"frames", r->frames}, {"kept", r->kept}, {"work", work}, {"exact", r->exact}};
    }
    const std::string record = made.record.empty() ? "null" : concat_text(made.number);
    std::string out = concat_text("{\"motion\":", made.number, ",\"record\":", record, ",\"reuse\":", text_of(reuse),
                                  ",\"data\":", viewer_data(*made.motion), "}");
    remember(client, std::move(made));
    return out;
  }
  /// The first of numbers that were not given before.
  Index next(Index count = 1) {
    const std::lock_guard lock(mutex_);
    return std::exchange(made_, made_ + count) + 1;
  }
  void remember(detail::StudioClient& client, detail::StudioClient::Made made) const {
    const std::lock_guard lock(client.mutex);
    client.motions.push_back(std::move(made));
    if (std::ssize(client.motions) <= o_.motions) return;
    detail::StudioClient::forget(client.motions.front());
    client.motions.pop_front();
  }

  /// The file of a motion; on a character, if the question has one. With a name it is written to the project.
  std::string saved(const StudioQuestion& q, detail::StudioClient& client) {
    const auto made = motion_of(client, q.motion);
    if (!is_studio_file("motion" + q.format)) raise<config_error>(103, "question.format: '", q.format, "'");
    const auto bytes = [&]() -> std::vector<std::byte> {
      if (!q.has_character || (q.format != ".glb" && q.format != ".html"))
        return motion_or_view_bytes(q.format, *made.motion);
      const GlbRig rig(q.bytes, q.name);
      if (q.format == ".glb") return rig.with(std::span(made.motion.get(), 1));
      const std::string page = rig_viewer_html(rig, std::span(made.motion.get(), 1));
      const auto view = std::as_bytes(std::span(page));
      return {view.begin(), view.end()};
    }();
    if (q.id.empty()) return text_of(packed(bytes));
    const std::lock_guard lock(writes_);
    folder().write(q.id, bytes);
    return "true";
  }

  bool searches() const { return folder_.has_value() && o_.search_model != nullptr; }
  /// The moments of the folder's motions that are nearest to words. One client at a time searches, because the files
  /// that are new may take long.
  std::string found(const StudioQuestion& q, detail::StudioClient& client, const StudioWriter& write) {
    if (!searches()) raise<config_error>(101, "this server searches no folder");
    if (q.words.empty()) raise<config_error>(101, "there are no words to search for");
    const Turn turn = turn_for(searches_, write);
    if (!searched_)
      searched_.emplace(o_.project, o_.search_model(),
                        SearchedFolderOptions{.index = o_.project / ".motionlang.index", .moments = {}});
    const auto progress = steps_to(write);
    const FolderAnswer answer = searched_->find(q.words, q.count > 0 ? q.count : 10, progress);
    nlohmann::ordered_json moments = nlohmann::ordered_json::array();
    const Index first = next(std::ssize(answer.moments));
    const std::lock_guard lock(client.mutex);
    for (const FolderMoment& m : answer.moments) {
      const Index number = first + std::ssize(moments);
      client.found.emplace(number, m);
      const std::string name = m.animation.empty() ? m.file : concat_text(m.file, " (", m.animation, ")");
      moments.push_back({{"number", number}, {"name", name}, {"start", m.start}, {"end", m.end}, {"score", m.score}});
    }
    while (std::ssize(client.found) > o_.limits.remembered) client.found.erase(client.found.begin());
    return text_of({{"moments", std::move(moments)},
                    {"shows", answer.shown},
                    {"unknown", answer.unknown},
                    {"clips", answer.clips},
                    {"skipped", answer.skipped}});
  }
  /// A found moment as a file, with some of the motion before and after it.
  std::string moment(const StudioQuestion& q, detail::StudioClient& client) const {
    constexpr double margin = 2;  // seconds
    const FolderMoment m = [&] {
      const std::lock_guard lock(client.mutex);
      const auto known = client.found.find(q.motion);
      if (known == client.found.end()) raise<config_error>(101, "this moment is gone; search again");
      return known->second;
    }();
    const FolderPiece piece = searched_->piece(m, margin);
    const std::string name = std::filesystem::path(m.file).stem().string();
    return text_of({{"name", concat_text(name, formatted("_%.1fs.glb", m.start))},
                    {"from", piece.start},
                    {"seconds", piece.end - piece.start},
                    {"bytes", packed(motion_bytes(".glb", piece.motion))}});
  }

  std::shared_ptr<const MotionModel> model_;
  StudioServerOptions o_;
  detail::StudioTurns turns_, searches_;
  std::optional<ProjectFolder> folder_;
  std::optional<SearchedFolder> searched_;  // who has the turn of searches makes it
  std::string page_;
  std::mutex mutex_, writes_;
  std::map<std::string, std::shared_ptr<detail::StudioClient>> clients_;
  std::uint64_t questions_ = 0;
  Index made_ = 0;
};

MOTIONLANG_BODY StudioServer::StudioServer(std::shared_ptr<const MotionModel> model, StudioServerOptions options)
    : body_(std::make_unique<Body>(std::move(model), std::move(options))) {}
MOTIONLANG_BODY StudioServer::~StudioServer() = default;
MOTIONLANG_BODY const std::string& StudioServer::page() const { return body_->page(); }
MOTIONLANG_BODY const StudioLimits& StudioServer::limits() const { return body_->options().limits; }
MOTIONLANG_BODY void StudioServer::answer(std::string_view question, const StudioWriter& write) {
  std::string line;
  const auto work = [&] { line = concat_text("{\"value\":", body_->value(question, write), "}\n"); };
  detail::guard<std::exception>(work, [&](const std::exception& e) {
    line = detail::json_text(nlohmann::ordered_json{{"error", e.what()}}) + "\n";
    return true;
  });
  write(line);
}

MOTIONLANG_NAMESPACE_END
