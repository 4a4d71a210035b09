// SPDX-License-Identifier: MIT
// motionlang_c.h in terms of the templates. Without MOTIONLANG_INSTANTIATED this unit makes the whole shared library.
#define MOTIONLANG_C_BUILD
#include <motionlang/c/motionlang_c.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/formats/features_npy.hpp>
#include <motionlang/generate/kept_clip_text.hpp>
#include <motionlang/generate/load_trained_motion_model.hpp>
#include <motionlang/generate/timeline_report.hpp>
#include <motionlang/generate/timelines_of_text.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/search/kept_index.hpp>
#include <motionlang/search/searched_folder.hpp>
#include <motionlang/search/text_answer.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>
#include <motionlang/view/rig_viewer.hpp>
#include <motionlang/view/rig_writer.hpp>
#include <motionlang/view/view_file.hpp>
#include <motionlang/view/viewer.hpp>

namespace ml = motionlang;

using B = ml::EigenBackend<float>;

struct motionlang_model {
  std::unique_ptr<const ml::MotionModel> model;
};
struct motionlang_motion {
  ml::Motion motion;
  motionlang_reuse reuse{};
};
struct motionlang_motions {
  std::vector<motionlang_motion> motions;
  std::string notes;
};
struct motionlang_bytes {
  std::vector<std::byte> bytes;
};
struct motionlang_index {
  std::unique_ptr<const ml::MotionIndexFile> file;
  ml::TmrSearchEncoder<B> tmr;
  ml::MotionSearch search;
};
struct motionlang_hits {
  struct Hit {
    ml::IndexedClip clip;
    ml::MotionHit hit;
    double score;
  };
  std::vector<Hit> hits;
  bool shown = true;
  std::string unknown_words;
};

namespace {

std::string& message() { return ml::thread_object<std::string, motionlang_model>(); }

/// The id of the error that f throws, with its message kept; 0 if f does not throw.
template <class F>
int done(const F& f) noexcept {
  try {
    try {
      f();
      return 0;
    } catch (const ml::cancelled& e) {
      message() = e.what();
      return MOTIONLANG_CANCELLED;
    } catch (const ml::error& e) {
      message() = e.what();
      return e.id();
    } catch (const std::exception& e) {
      message() = e.what();
    }
  } catch (...) {  // no memory for the message
  }
  return MOTIONLANG_FAILED;
}

template <class T>
T& given(T* argument, const char* name) {
  if (argument == nullptr) ml::raise<ml::config_error>(101, name, " is NULL");
  return *argument;
}

/// Calls done for a result that the caller then owns: a T from f, or NULL if f fails.
template <class T, class F>
int made(T** result, const char* name, const F& f) noexcept {
  return done([&] {
    T*& out = given(result, name);
    out = nullptr;
    out = new T{f()};
  });
}

ml::MotionReadOptions read_options(const motionlang_read_options* given_options) {
  const motionlang_read_options o = given_options == nullptr ? motionlang_default_read_options() : *given_options;
  constexpr struct {
    int letter;
    ml::UpAxis axis;
  } ups[] = {{0, ml::UpAxis::found},     {'y', ml::UpAxis::y},       {'z', ml::UpAxis::z},      {'x', ml::UpAxis::x},
             {-'y', ml::UpAxis::y_down}, {-'z', ml::UpAxis::z_down}, {-'x', ml::UpAxis::x_down}};
  const auto* const up = std::find_if(std::begin(ups), std::end(ups), [&](const auto& u) { return u.letter == o.up; });
  if (up == std::end(ups))
    ml::raise<ml::config_error>(103, "motionlang_read_options: up is ", o.up,
                                ", not 0, 'x', 'y', 'z' or the negative of a letter");
  ml::MotionReadOptions out{.scale = o.scale, .rate = o.rate, .drop_lead_in = o.drop_lead_in != 0};
  if (o.fps != 0) out.fps = o.fps;
  out.up = up->axis;
  if (o.asf != nullptr) out.asf = o.asf;
  if (o.joints != nullptr) out.joints = o.joints;
  return out;
}
motionlang_motions with_handles(std::vector<ml::Motion> motions, std::string notes) {
  motionlang_motions out{{}, std::move(notes)};
  for (ml::Motion& m : motions) out.motions.push_back({std::move(m)});
  return out;
}
std::vector<ml::Motion> copies_of(const motionlang_motion* const* motions, int64_t count) {
  if (count < 0) ml::raise<ml::config_error>(101, ml::counted(count, "motion"));
  if (count > 0) given(motions, "motions");
  std::vector<ml::Motion> out;
  for (int64_t i = 0; i < count; ++i) out.push_back(given(motions[i], "a motion").motion);
  return out;
}
std::string or_empty(const char* text) { return text == nullptr ? "" : text; }
ml::TmrSearchEncoder<B> tmr_of(const std::string& folder, const std::string& text_encoder) {
  return ml::TmrSearchEncoder<B>(ml::load_tmr<B>(folder, {.text_encoder = text_encoder}));
}
ml::SearchOptions search_options(const motionlang_search_options* given_options) {
  const motionlang_search_options o = given_options == nullptr ? motionlang_default_search_options() : *given_options;
  if (o.what < MOTIONLANG_SEARCH_CLIPS || o.what > MOTIONLANG_SEARCH_CAPTIONS)
    ml::raise<ml::config_error>(103, "motionlang_search_options: what is ", o.what, ", not 0, 1 or 2");
  return {.top = static_cast<ml::Index>(o.top),
          .what = o.what == MOTIONLANG_SEARCH_MOMENTS    ? ml::SearchFor::moments
                  : o.what == MOTIONLANG_SEARCH_CAPTIONS ? ml::SearchFor::captions
                                                         : ml::SearchFor::clips,
          .most_overlap = o.most_overlap};
}
motionlang_hits hits_of(const motionlang_index& index, const ml::TextAnswer& answer) {
  motionlang_hits out;
  for (std::size_t i = 0; i < answer.hits.size(); ++i)
    out.hits.push_back({ml::clip_of(index.file->index(), answer.hits[i]), answer.hits[i], answer.scores[i]});
  out.shown = answer.shown;
  for (const ml::UnknownWord& w : answer.unheard) out.unknown_words += (out.unknown_words.empty() ? "" : " ") + w.word;
  return out;
}
const motionlang_hits::Hit& hit_at(const motionlang_hits* hits, int64_t i) {
  const auto count = motionlang_hits_count(hits);
  if (i < 0 || i >= count) ml::raise<ml::shape_error>(203, "hit ", i, " of ", count);
  return hits->hits[static_cast<std::size_t>(i)];
}
std::span<const std::byte> memory(const void* bytes, int64_t size) {
  if (size < 0) ml::raise<ml::config_error>(101, ml::counted(size, "byte"));
  const auto* first = static_cast<const std::byte*>(bytes);
  if (size > 0) given(first, "bytes");
  return {first, static_cast<std::size_t>(size)};
}

std::array<double, 3> numbers_of(const ml::Vec3<double>& v) { return {v.x, v.y, v.z}; }
std::array<double, 4> numbers_of(const ml::Quaternion<double>& q) { return {q.w, q.x, q.y, q.z}; }
/// Copies all values in order. Throws shape_error 205 unless there is room for exactly that many.
template <class V>
void copy_to(float* out, int64_t room, const std::vector<V>& values) {
  const auto count = static_cast<int64_t>(values.size() * numbers_of(V{}).size());
  if (room != count) ml::raise<ml::shape_error>(205, "room for ", room, " floats, there are ", count);
  if (count > 0) given(out, "memory for the numbers");
  for (const V& v : values) {
    for (const double x : numbers_of(v)) *out++ = static_cast<float>(x);
  }
}

motionlang_bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {{bytes.begin(), bytes.end()}};
}

/// The stretches and parts of a motion to keep.
ml::KeptClip kept_clip(const motionlang_options& o) {
  if (o.keep_stretches < 0) ml::raise<ml::config_error>(101, ml::counted(o.keep_stretches, "stretch", "stretches"));
  ml::KeptClip out{.motion = o.keep->motion};
  for (int64_t i = 0; i < o.keep_stretches; ++i) {
    const double* stretch = &given(o.keep_seconds, "keep_seconds") + 2 * i;
    out.seconds.emplace_back(stretch[0], stretch[1]);
  }
  if (o.keep_parts != nullptr) out.parts = ml::parse_kept_parts(o.keep_parts);
  return out;
}
/// The options without progress.
ml::GenerateOptions generate_options(const motionlang_options& o) {
  ml::GenerateOptions out{.seed = o.seed,
                          .overlap = o.overlap,
                          .cut_texts = o.cut_texts != 0,
                          .smooth = o.smooth != 0,
                          .fix_feet = o.fix_feet != 0,
                          .fix_floor = o.fix_floor != 0,
                          .overlay_arms = o.overlay_arms != 0};
  if (o.steps != 0) out.steps = o.steps;
  if (o.all_steps != 0) out.steps = 0;
  if (o.guidance != 0) out.guidance = o.guidance;
  if (o.sampler != nullptr) out.sampler = ml::parse_sampler(o.sampler);
  if (o.mode != nullptr) out.mode = ml::parse_stmc_mode(o.mode);
  if (o.noise != nullptr) out.noise = o.noise;
  if (o.record != nullptr) out.record = o.record;
  if (o.reuse != nullptr) out.reuse = o.reuse;
  if (o.keep_beyond > 0) out.keep_beyond = o.keep_beyond;
  if (o.keep != nullptr) out.keep = kept_clip(o);
  return out;
}

/// Calls f(options) with the caller's function for progress.
template <class F>
auto with_options(const motionlang_options* options, const F& f) {
  const motionlang_options o = options == nullptr ? motionlang_default_options() : *options;
  const auto progress = [&](ml::Index step, ml::Index of) {
    return o.progress == nullptr || o.progress(o.user, step, of) != 0;
  };
  ml::GenerateOptions how = generate_options(o);
  how.progress = progress;
  return f(how);
}

}  // namespace

const char* motionlang_version(void) { return MOTIONLANG_VERSION; }
const char* motionlang_message(void) { return message().c_str(); }
int motionlang_set_threads(int32_t threads) {
  return done([&] { ml::set_thread_count(threads); });
}

int motionlang_load_model(const char* file, motionlang_model** model) {
  return motionlang_load_model_with(file, nullptr, nullptr, model);
}
int motionlang_load_model_with(const char* path, const char* text_encoder, const char* statistics,
                               motionlang_model** model) {
  return made(model, "model", [&] {
    return ml::load_motion_model<B>(
        &given(path, "file"), {.sources = {.text_encoder = or_empty(text_encoder), .statistics = or_empty(statistics)},
                               .trained = ml::load_trained_motion_model<B>});
  });
}
void motionlang_free_model(motionlang_model* model) { delete model; }
double motionlang_model_fps(const motionlang_model* model) { return model == nullptr ? 0 : model->model->fps(); }
int32_t motionlang_model_takes_actions(const motionlang_model* model) {
  return model != nullptr && model->model->takes_actions() ? 1 : 0;
}

motionlang_options motionlang_default_options(void) {
  const ml::GenerateOptions usual;
  motionlang_options o{};
  o.cut_texts = usual.cut_texts, o.smooth = usual.smooth, o.fix_feet = usual.fix_feet;
  o.fix_floor = usual.fix_floor, o.overlay_arms = usual.overlay_arms;
  o.overlap = usual.overlap;
  return o;
}

int motionlang_generate(const motionlang_model* model, const char* timeline, const motionlang_options* options,
                        motionlang_motion** motion) {
  return made(motion, "motion", [&] {
    const ml::MotionModel& loaded = *given(model, "model").model;
    const auto text = ml::parse_timeline(&given(timeline, "timeline"), {.fps = loaded.fps()});
    return with_options(options, [&](ml::GenerateOptions how) {
      ml::GenerateNotes notes;
      how.notes = &notes;
      motionlang_motion out{ml::generate_motion(loaded, text, how)};
      if (const auto& r = notes.reuse) out.reuse = {r->frames, r->kept, r->work, r->whole_work, r->exact ? 1 : 0};
      return out;
    });
  });
}
motionlang_reuse motionlang_motion_reuse(const motionlang_motion* motion) {
  return motion == nullptr ? motionlang_reuse{} : motion->reuse;
}
int motionlang_cut_motion(const motionlang_motion* motion, double from, double to, double start,
                          motionlang_motion** result) {
  return made(result, "result", [&] {
    const ml::Motion& whole = given(motion, "motion").motion;
    const double last = whole.seconds();
    if (!(from >= 0 && from <= to && to <= last + 1))
      ml::raise<ml::config_error>(101, "motionlang_cut_motion: ", from, " to ", to, " s of ", last, " s");
    return ml::kept_part(whole, from, to, start);
  });
}
int motionlang_generate_text(const motionlang_model* model, const char* text, double seconds,
                             const motionlang_options* options, motionlang_motion** motion) {
  return made(motion, "motion", [&] {
    const ml::MotionModel& loaded = *given(model, "model").model;
    const std::string of = &given(text, "text");
    if (of.empty() || !(seconds == 0 || seconds >= 0.05))
      ml::raise<ml::config_error>(101, "motionlang_generate_text: '", of, "' for ", seconds, " s");
    return with_options(options, [&](const ml::GenerateOptions& how) {
      ml::TextTimelineOptions times{.fps = loaded.fps(), .end_actions = ml::ends_actions(how)};
      if (seconds > 0) times.seconds = seconds;
      const ml::Index frames = ml::frame_at(times.seconds.value_or(ml::text_seconds), times.fps);
      return ml::generate_motion(loaded,
                                 loaded.takes_timelines() ? ml::text_timeline(of, loaded.captions(), times)
                                                          : ml::whole_body_timeline(of, frames),
                                 how);
    });
  });
}
int motionlang_generate_motions(const motionlang_model* model, const char* timelines, const motionlang_options* options,
                                motionlang_motions** motions) {
  return made(motions, "motions", [&] {
    const ml::MotionModel& loaded = *given(model, "model").model;
    const auto texts = ml::timelines_of_text(&given(timelines, "timelines"), {.fps = loaded.fps()});
    return with_handles(
        with_options(options, [&](const ml::GenerateOptions& how) { return ml::generate_motions(loaded, texts, how); }),
        "");
  });
}

int motionlang_known_texts(const motionlang_model* model, const char* begun, int64_t count, motionlang_bytes** json) {
  return made(json, "json", [&] {
    const ml::KnownCaptions& known = given(model, "model").model->captions();
    return bytes_of(ml::known_texts_report(ml::known_texts(known, or_empty(begun), static_cast<ml::Index>(count))));
  });
}
int motionlang_check_timeline(const motionlang_model* model, const char* timeline, motionlang_bytes** json) {
  return made(json, "json", [&] {
    return bytes_of(ml::timeline_report(*given(model, "model").model, &given(timeline, "timeline")));
  });
}

motionlang_read_options motionlang_default_read_options(void) {
  motionlang_read_options o{};
  o.scale = ml::MotionReadOptions{}.scale;
  return o;
}
int motionlang_read_motions(const char* file, const motionlang_read_options* options, motionlang_motions** motions) {
  return made(motions, "motions", [&] {
    std::string notes;
    auto read = ml::read_motions(&given(file, "file"), read_options(options), &notes);
    return with_handles(std::move(read), std::move(notes));
  });
}
int motionlang_parse_motions(const void* bytes, int64_t size, const char* name, const motionlang_read_options* options,
                             motionlang_motions** motions) {
  return made(motions, "motions", [&] {
    std::string notes;
    auto read = ml::parse_motions(memory(bytes, size), &given(name, "name"), read_options(options), &notes);
    return with_handles(std::move(read), std::move(notes));
  });
}
int motionlang_read_motion(const char* file, motionlang_motion** motion) {
  return made(motion, "motion", [&] { return std::move(ml::read_motions(&given(file, "file")).front()); });
}

int64_t motionlang_motions_count(const motionlang_motions* motions) {
  return motions == nullptr ? 0 : std::ssize(motions->motions);
}
const motionlang_motion* motionlang_motions_at(const motionlang_motions* motions, int64_t i) {
  return i < 0 || i >= motionlang_motions_count(motions) ? nullptr : &motions->motions[static_cast<std::size_t>(i)];
}
const char* motionlang_motions_notes(const motionlang_motions* motions) {
  return motions == nullptr ? "" : motions->notes.c_str();
}
void motionlang_free_motions(motionlang_motions* motions) { delete motions; }

int motionlang_write_motion(const motionlang_motion* motion, const char* file) {
  return done([&] { ml::write_motion_or_view(&given(file, "file"), given(motion, "motion").motion); });
}
int motionlang_write_motions(const motionlang_motion* const* motions, int64_t count, const char* file) {
  return done([&] { ml::write_motions(&given(file, "file"), copies_of(motions, count)); });
}
int motionlang_write_on_character(const motionlang_motion* const* motions, int64_t count, const char* character,
                                  const char* joints, const char* file) {
  return done([&] {
    const std::string rig = &given(character, "character"), result = &given(file, "file");
    if (rig.empty()) ml::raise<ml::config_error>(101, "character is empty");
    ml::rig_writer({.file = rig, .joints = or_empty(joints)})(result, copies_of(motions, count));
  });
}
int motionlang_write_features(const motionlang_motion* motion, const char* features, const char* file) {
  return done([&] {
    const ml::MotionFeatures& wanted = ml::motion_features(&given(features, "features"));
    ml::write_features_npy(&given(file, "file"), given(motion, "motion").motion, wanted);
  });
}
int motionlang_motion_bytes(const motionlang_motion* motion, const char* kind, motionlang_bytes** bytes) {
  return made(bytes, "bytes",
              [&] { return ml::motion_or_view_bytes(&given(kind, "kind"), given(motion, "motion").motion); });
}
int motionlang_viewer_data(const motionlang_motion* motion, motionlang_bytes** json) {
  return made(json, "json", [&] { return bytes_of(ml::viewer_data(given(motion, "motion").motion)); });
}
int motionlang_viewer_data_on(const motionlang_motion* motion, const void* character, int64_t size, const char* name,
                              motionlang_bytes** json) {
  return made(json, "json", [&] {
    const ml::GlbRig rig(memory(character, size), &given(name, "name"));
    return bytes_of(ml::rig_viewer_data(rig, given(motion, "motion").motion));
  });
}
const void* motionlang_bytes_data(const motionlang_bytes* bytes) {
  return bytes == nullptr ? nullptr : bytes->bytes.data();
}
int64_t motionlang_bytes_size(const motionlang_bytes* bytes) { return bytes == nullptr ? 0 : std::ssize(bytes->bytes); }
void motionlang_free_bytes(motionlang_bytes* bytes) { delete bytes; }
const char* motionlang_motion_name(const motionlang_motion* motion) {
  return motion == nullptr ? "" : motion->motion.name.c_str();
}

int motionlang_retarget(const motionlang_motion* motion, const motionlang_motion* character,
                        motionlang_motion** result) {
  return made(result, "result", [&] {
    return ml::retarget(given(motion, "motion").motion, given(character, "character").motion.skeleton);
  });
}
void motionlang_free_motion(motionlang_motion* motion) { delete motion; }

int64_t motionlang_frames(const motionlang_motion* motion) { return motion == nullptr ? 0 : motion->motion.frames(); }
int32_t motionlang_joints(const motionlang_motion* motion) {
  return motion == nullptr ? 0 : motion->motion.skeleton.size();
}
double motionlang_fps(const motionlang_motion* motion) { return motion == nullptr ? 0 : motion->motion.fps; }
const char* motionlang_joint_name(const motionlang_motion* motion, int32_t joint) {
  return joint < 0 || joint >= motionlang_joints(motion)
             ? nullptr
             : motion->motion.skeleton.names[static_cast<std::size_t>(joint)].c_str();
}
int32_t motionlang_joint_parent(const motionlang_motion* motion, int32_t joint) {
  return joint < 0 || joint >= motionlang_joints(motion) ? -1 : motion->motion.skeleton.parent(joint);
}

int motionlang_offsets(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.skeleton.offsets); });
}
int motionlang_root(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.root); });
}
int motionlang_rotations(const motionlang_motion* motion, float* wxyz, int64_t room) {
  return done([&] { copy_to(wxyz, room, given(motion, "motion").motion.local); });
}
int motionlang_positions(const motionlang_motion* motion, float* xyz, int64_t room) {
  return done([&] { copy_to(xyz, room, given(motion, "motion").motion.positions()); });
}

motionlang_index_options motionlang_default_index_options(void) {
  motionlang_index_options o{};
  o.moments = 1;
  return o;
}
int motionlang_update_index(const char* index_file, const char* folder, const motionlang_index_options* options,
                            motionlang_index_report* report) {
  return done([&] {
    const motionlang_index_options o = options == nullptr ? motionlang_default_index_options() : *options;
    const std::filesystem::path file = &given(index_file, "index_file");
    given(folder, "folder");
    ml::KeptIndex kept(file);
    if (!kept.has_index()) given(o.model, "model of a new index");
    const auto tmr =
        tmr_of(kept.model_path(or_empty(o.model), "").string(), kept.text_encoder(or_empty(o.text_encoder)));
    const ml::MomentOptions moments{.windows = o.moments != 0 ? ml::MomentOptions{}.windows : std::vector<double>{}};
    kept.take_model(tmr, kept.has_index() ? nullptr : &moments);
    const auto progress = [&](ml::Index files, ml::Index of) {
      return o.progress == nullptr || o.progress(o.user, files, of) != 0;
    };
    ml::IndexUpdate update(kept.index(), folder, tmr, {.license = or_empty(o.license), .again = o.again != 0});
    const bool stopped =
        !ml::detail::guard<ml::cancelled>([&] { update.run(progress); }, [](const ml::cancelled&) { return true; });
    stopped ? kept.write_without_graphs() : static_cast<void>(kept.write());
    const ml::IndexReport& r = update.report();
    if (report != nullptr)
      *report = {kept.index().count(), r.added, r.removed, r.renamed, r.unchanged, std::ssize(r.skipped)};
    if (stopped) throw ml::cancelled();
  });
}
int motionlang_open_index(const char* index_file, const char* model, const char* text_encoder,
                          motionlang_index** index) {
  return made(index, "index", [&] {
    auto file =
        std::make_unique<const ml::MotionIndexFile>(ml::MotionIndexFile::open(&given(index_file, "index_file")));
    const ml::IndexModel& made_with = file->index().model();
    const std::string path = model != nullptr ? model : made_with.path;
    auto tmr = tmr_of(path, text_encoder != nullptr ? text_encoder : made_with.text_encoder);
    file->index().require_model(tmr.model().id, path);
    ml::MotionSearch search = ml::open_motion_search(*file);
    return motionlang_index{std::move(file), std::move(tmr), std::move(search)};
  });
}
int64_t motionlang_index_clips(const motionlang_index* index) {
  return index == nullptr ? 0 : index->file->index().count();
}
void motionlang_free_index(motionlang_index* index) { delete index; }

motionlang_search_options motionlang_default_search_options(void) {
  const ml::SearchOptions o;
  return {o.top, MOTIONLANG_SEARCH_CLIPS, o.most_overlap};
}
int motionlang_search_text(const motionlang_index* index, const char* text, const motionlang_search_options* options,
                           motionlang_hits** hits) {
  return made(hits, "hits", [&] {
    const auto& searched = given(index, "index");
    return hits_of(searched,
                   ml::answer_text(searched.search, searched.tmr, &given(text, "text"), search_options(options)));
  });
}
int motionlang_search_motion(const motionlang_index* index, const motionlang_motion* motion,
                             const motionlang_search_options* options, motionlang_hits** hits) {
  return made(hits, "hits", [&] {
    const auto& searched = given(index, "index");
    ml::TextAnswer answer{.hits = ml::search(searched.search,
                                             ml::encode_motion(searched.tmr, given(motion, "motion").motion),
                                             search_options(options))};
    for (const ml::MotionHit& hit : answer.hits) answer.scores.push_back(ml::score_of(hit));
    return hits_of(searched, answer);
  });
}
int64_t motionlang_hits_count(const motionlang_hits* hits) { return hits == nullptr ? 0 : std::ssize(hits->hits); }
int motionlang_hits_at(const motionlang_hits* hits, int64_t i, motionlang_hit* hit) {
  return done([&] {
    motionlang_hit& out = given(hit, "hit");
    const auto& [clip, found, score] = hit_at(hits, i);
    out = {clip.path.c_str(),
           clip.name.c_str(),
           clip.captions.empty() ? "" : clip.captions.front().c_str(),
           clip.license.c_str(),
           found.start,
           found.end,
           score};
  });
}
int motionlang_hits_motion(const motionlang_hits* hits, int64_t i, double margin, double stretch[2],
                           motionlang_motion** motion) {
  return made(motion, "motion", [&] {
    const auto& [clip, found, score] = hit_at(hits, i);
    if (!(margin >= 0)) ml::raise<ml::config_error>(101, "margin is ", margin, " s");
    ml::FolderPiece piece = ml::piece_of_file(clip.path, clip.name, found.start, found.end, margin);
    if (stretch != nullptr) stretch[0] = piece.start, stretch[1] = piece.end;
    return motionlang_motion{std::move(piece.motion)};
  });
}
int motionlang_hits_shown(const motionlang_hits* hits) { return hits != nullptr && hits->shown ? 1 : 0; }
const char* motionlang_hits_unknown_words(const motionlang_hits* hits) {
  return hits == nullptr ? "" : hits->unknown_words.c_str();
}
void motionlang_free_hits(motionlang_hits* hits) { delete hits; }
