// SPDX-License-Identifier: MIT
// Bodies of judged_prompts.hpp.
#pragma once

#include <algorithm>  // any_of, count_if, fill_n, max
#include <ctime>      // time of the processor
#include <map>        // texts
#include <utility>    // pair

#include <motionlang/compose/detail/timeline_line.hpp>
#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/generate/judged_prompts.hpp>
#include <motionlang/generate/shared_motions.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/metrics/motion_quality.hpp>
#include <motionlang/train/messages.hpp>
#include <motionlang/train/shared_progress.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The change of the bones in the positions that the features contain; rotations would keep bones constant.
inline double bone_change(const std::vector<double>& features) {
  std::vector<Vec3<double>> positions;
  for (std::size_t at = 0; at < features.size(); at += smplrifke_size) {
    positions.push_back({});
    for (std::size_t j = at + 136; j < at + 205; j += 3)
      positions.push_back({features[j], features[j + 1], features[j + 2]});
  }
  return bone_length_deviation({positions, smplrifke_joints}, smpl24_skeleton().parents);
}

/// Texts and verbs as prompts of one text.
inline std::vector<JudgedPrompt> single_prompts(std::initializer_list<std::pair<const char*, const char*>> list,
                                                double seconds) {
  std::vector<JudgedPrompt> out;
  for (const auto& [text, verb] : list) out.push_back({{{text, verb}}, seconds});
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::string JudgedPrompt::name() const {
  return join_text(texts, " + ", [](const JudgedText& t) { return t.text; });
}
MOTIONLANG_BODY std::string JudgedPrompt::rule() const {
  return join_text(texts, "; ", [](const JudgedText& t) { return find_verb(t.verb).rule; });
}
MOTIONLANG_BODY Timeline JudgedPrompt::timeline(double fps) const {
  Timeline out;
  for (const JudgedText& t : texts)
    out.intervals.push_back({t.text, frame_at(t.from * seconds, fps), frame_at(t.to * seconds, fps), t.parts});
  return out;
}

MOTIONLANG_BODY Timeline JudgedPrompt::timeline(const MotionModel& model, const GenerateOptions& options) const {
  if (texts.size() != 1 || texts[0].from != 0 || texts[0].to != 1 || !(texts[0].parts == BodyParts::all()))
    return timeline(model.fps());
  return text_timeline(texts[0].text, model.captions(),
                       {.seconds = seconds, .fps = model.fps(), .end_actions = ends_actions(options)});
}

MOTIONLANG_BODY std::vector<JudgedPrompt> own_prompts() {
  auto out = detail::single_prompts({{"walk forward", "walk"},
                                     {"run forward", "run"},
                                     {"walk backwards", "walk backwards"},
                                     {"walk slowly", "walk slowly"},
                                     {"stand still", "stand"},
                                     {"turn left", "turn left"},
                                     {"turn right", "turn right"},
                                     {"raise both arms", "raise both arms"},
                                     {"raise the right arm", "raise the right arm"},
                                     {"sit down", "sit down"},
                                     {"jump forward", "jump forward"},
                                     {"bend forward", "bend forward"}},
                                    3);
  for (const std::size_t longer : {0u, 3u, 4u}) out[longer].seconds = 4;
  out[10].seconds = 2.5;
  return out;
}

MOTIONLANG_BODY std::vector<JudgedPrompt> newcomers_prompts(double seconds) {
  return detail::single_prompts({{"walk", "walk"},
                                 {"walk forward", "walk"},
                                 {"walk backwards", "walk backwards"},
                                 {"walk slowly", "walk slowly"},
                                 {"a person walks in a circle", "walk in a circle"},
                                 {"walk to the left", "walk to the left"},
                                 {"strut", "walk anywhere"},
                                 {"sneak", "sneak"},
                                 {"march", "march"},
                                 {"run", "run"},
                                 {"run fast", "run"},
                                 {"jog", "jog"},
                                 {"sprint", "run"},
                                 {"jump", "jump"},
                                 {"jump up and down", "jump"},
                                 {"jump forward", "jump forward"},
                                 {"hop on one leg", "hop"},
                                 {"skip", "skip"},
                                 {"do jumping jacks", "jumping jack"},
                                 {"stand", "stand"},
                                 {"idle", "stand"},
                                 {"turn left", "turn left"},
                                 {"turn right", "turn right"},
                                 {"turn around", "turn around"},
                                 {"spin around", "spin"},
                                 {"sit", "sit down"},
                                 {"sit down", "sit down"},
                                 {"stand up", "stand up"},
                                 {"squat", "squat"},
                                 {"crouch down", "crouch"},
                                 {"kneel down", "kneel"},
                                 {"lie down", "lie down"},
                                 {"fall down", "fall"},
                                 {"crawl", "crawl"},
                                 {"wave", "wave"},
                                 {"wave hello", "wave"},
                                 {"wave with the right hand", "wave right"},
                                 {"clap", "clap"},
                                 {"raise your hand", "raise an arm"},
                                 {"raise both arms", "raise both arms"},
                                 {"point forward", "point"},
                                 {"punch", "punch"},
                                 {"box", "box"},
                                 {"kick", "kick"},
                                 {"throw a ball", "throw"},
                                 {"push something", "push"},
                                 {"pick something up", "pick up"},
                                 {"drink from a cup", "hand to the head"},
                                 {"salute", "hand to the head"},
                                 {"dance", "dance"},
                                 {"bow", "bow"},
                                 {"nod", "nod"},
                                 {"shake your head", "shake the head"},
                                 {"look around", "look around"},
                                 {"stretch", "stretch"},
                                 {"backflip", "flip"}},
                                seconds);
}

namespace detail {

/// Ten base movements with other texts over them from a quarter of the time on.
inline std::vector<JudgedPrompt> prompts_over_bases(std::initializer_list<JudgedText> over, double seconds) {
  const std::pair<const char*, const char*> bases[] = {{"walk forward", "walk"},
                                                       {"run forward", "run"},
                                                       {"walk backwards", "walk backwards"},
                                                       {"walk slowly", "walk slowly"},
                                                       {"stand still", "stand with free arms"},
                                                       {"turn left", "turn left"},
                                                       {"turn right", "turn right"},
                                                       {"sit down", "sit down"},
                                                       {"jump forward", "jump forward"},
                                                       {"bend forward", "bend forward"}};
  std::vector<JudgedPrompt> out;
  for (JudgedText text : over) {
    text.from = 0.25, text.to = 0.9;
    for (const auto& [base, verb] : bases) {
      const bool bends = text.parts.has(BodyPart::spine) && verb == std::string("bend forward");
      if (!bends) out.push_back({{{base, verb}, text}, seconds});  // the trunk can do only one of them
    }
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<JudgedPrompt> arm_prompts(double seconds) {
  using enum BodyPart;
  return detail::prompts_over_bases(
      {{"raise the right arm", "raise the right arm", BodyParts{}.with(right_arm)},
       {"raise the left arm", "raise the left arm", BodyParts{}.with(left_arm)},
       {"raise both arms", "raise both arms", BodyParts{}.with(left_arm).with(right_arm)}},
      seconds);
}
MOTIONLANG_BODY std::vector<JudgedPrompt> trunk_prompts(double seconds) {
  return detail::prompts_over_bases({{"look to the left", "look left", BodyParts{}.with(BodyPart::head)},
                                     {"twist the upper body", "twist", BodyParts{}.with(BodyPart::spine)}},
                                    seconds);
}

MOTIONLANG_BODY std::vector<JudgedPrompt> paraphrase_prompts(double seconds) {
  return detail::single_prompts({{"a person walks straight ahead", "walk"},
                                 {"someone is walking forward", "walk"},
                                 {"take steps forward", "walk"},
                                 {"a man is going for a walk", "walk"},
                                 {"she walks ahead at a normal pace", "walk"},
                                 {"a person is running", "run"},
                                 {"someone runs forward quickly", "run"},
                                 {"the figure sprints", "run"},
                                 {"a man jogs", "jog"},
                                 {"a person walks backward", "walk backwards"},
                                 {"walking in reverse", "walk backwards"},
                                 {"step backwards", "walk backwards"},
                                 {"go back a few steps", "walk backwards"},
                                 {"someone walks at a slow pace", "walk slowly"},
                                 {"a person is strolling", "walk slowly"},
                                 {"walk very slowly", "walk slowly"},
                                 {"a person is standing", "stand"},
                                 {"don't move", "stand"},
                                 {"someone stands without moving", "stand"},
                                 {"wait", "stand"},
                                 {"a person turns to the left", "turn left"},
                                 {"make a left turn", "turn left"},
                                 {"rotate left", "turn left"},
                                 {"a person turns to the right", "turn right"},
                                 {"make a right turn", "turn right"},
                                 {"rotate right", "turn right"},
                                 {"someone lifts both arms up", "raise both arms"},
                                 {"put your hands up", "raise both arms"},
                                 {"hands up", "raise both arms"},
                                 {"a person lifts the right arm", "raise the right arm"},
                                 {"right hand up", "raise the right arm"},
                                 {"raise your right hand", "raise the right arm"},
                                 {"a person takes a seat", "sit down"},
                                 {"someone is sitting down", "sit down"},
                                 {"sit on a chair", "sit down"},
                                 {"have a seat", "sit down"},
                                 {"a person leaps forward", "jump forward"},
                                 {"someone jumps ahead", "jump forward"},
                                 {"make a jump to the front", "jump forward"},
                                 {"long jump", "jump forward"},
                                 {"a person bends over", "bend forward"},
                                 {"someone leans forward", "bend forward"},
                                 {"bend down", "bend forward"},
                                 {"bend at the waist", "bend forward"}},
                                seconds);
}

MOTIONLANG_BODY std::vector<JudgedPrompt> parse_judged_prompts(std::string_view file, double seconds,
                                                               std::string_view name) {
  constexpr double usual = 4;
  std::vector<JudgedPrompt> out;
  detail::for_each_line(file, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, name);
    if (line.fields() < 2 || line.fields() > 3) line.fail(501, line.fields(), "expected 'text # verb # seconds'");
    const JudgedVerb* verb = known_verb(line.field(1));
    if (verb == nullptr)
      line.fail(501, 1, "'", line.field(1), "' is not one of the verbs: ",
                join_text(judged_verbs(), ", ", [](const JudgedVerb& v) { return v.name; }));
    out.push_back({{{line.text(), verb->name}}, line.fields() == 3 ? line.seconds(2) : seconds > 0 ? seconds : usual});
  });
  if (out.empty()) raise<timeline_error>(507, name, ": no line");
  return out;
}

MOTIONLANG_BODY Verdict verdict(const JudgedPrompt& prompt, const Motion& motion) {
  const MotionTrace whole = trace_motion(motion);
  Verdict out;
  out.hovers = longest_hover(whole) > EyeLimits{}.hover;
  out.sinks = sunken_seconds(whole) > EyeLimits{}.sunken;
  const bool rests = std::any_of(prompt.texts.begin(), prompt.texts.end(),
                                 [](const JudgedText& t) { return find_verb(t.verb).rests; });
  out.still = !rests && still_share(whole) > EyeLimits{}.still;
  out.speed = whole.forward.empty() ? 0 : whole.forward.back() / std::max(1e-9, whole.seconds());
  for (const Flight& f : flights(whole)) out.air = std::max(out.air, f.seconds);
  out.turned = whole.turned();
  for (const JudgedText& text : prompt.texts) {
    const bool all = text.from == 0 && text.to == 1;
    const auto frame = [&](double share, double earlier) {
      return static_cast<std::size_t>(
          std::max(0.0, share * static_cast<double>(whole.frames()) - earlier * whole.fps + 0.5));
    };
    out.why_not = all ? why_not_done(find_verb(text.verb), whole)
                      : find_verb(text.verb).why_not(part_of(whole, frame(text.from, 0.3), frame(text.to, 0)));
    if (!out.why_not.empty()) break;
  }
  return out;
}

namespace detail {

template <class F>
double share_of(const std::vector<std::vector<Verdict>>& verdicts, F f) {
  double count = 0, all = 0;
  for (const auto& of_prompt : verdicts) {
    all += static_cast<double>(of_prompt.size());
    count += static_cast<double>(std::count_if(of_prompt.begin(), of_prompt.end(), f));
  }
  return all == 0 ? 0 : count / all;
}

}  // namespace detail

MOTIONLANG_BODY std::size_t Judgement::done(std::size_t prompt) const {
  const auto& of_prompt = verdicts[prompt];
  return static_cast<std::size_t>(
      std::count_if(of_prompt.begin(), of_prompt.end(), [](const Verdict& v) { return v.why_not.empty(); }));
}
MOTIONLANG_BODY std::size_t Judgement::done() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < verdicts.size(); ++i) n += done(i);
  return n;
}
MOTIONLANG_BODY double Judgement::hovering() const {
  return detail::share_of(verdicts, [](const Verdict& v) { return v.hovers; });
}
MOTIONLANG_BODY double Judgement::sinking() const {
  return detail::share_of(verdicts, [](const Verdict& v) { return v.sinks; });
}
MOTIONLANG_BODY double Judgement::statues() const {
  return detail::share_of(verdicts, [](const Verdict& v) { return v.still; });
}

namespace detail {

/// A motion with what is measured on it.
struct JudgedMotion {
  Verdict verdict{};
  std::vector<Vec3<double>> positions{};
  double skate = 0, jitter = 0, bones = 0;
  Motion motion{};  // if it is kept
};

inline void put_judged(MessageWriter& out, const JudgedMotion& j) {
  const Verdict& v = j.verdict;
  out.text(v.why_not);
  for (const bool b : {v.hovers, v.sinks, v.still}) out.value(std::uint8_t{b});
  for (const double d : {v.speed, v.air, v.turned, j.skate, j.jitter, j.bones}) out.value(d);
  out.list(std::span<const Vec3<double>>(j.positions));
  put_motion(out, j.motion);
}
inline JudgedMotion take_judged(MessageReader& in) {
  JudgedMotion j;
  Verdict& v = j.verdict;
  v.why_not = in.text();
  for (bool* b : {&v.hovers, &v.sinks, &v.still}) *b = in.value<std::uint8_t>() != 0;
  for (double* d : {&v.speed, &v.air, &v.turned, &j.skate, &j.jitter, &j.bones}) *d = in.value<double>();
  j.positions = in.list<Vec3<double>>();
  j.motion = take_motion(in);
  return j;
}

/// The motions of all prompts with one seed.
inline std::vector<JudgedMotion> judge_seed(const MotionModel& model, const std::vector<JudgedPrompt>& prompts,
                                            std::span<const Timeline> timelines, const GenerateOptions& options,
                                            bool keep_motions) {
  GenerateNotes notes;
  GenerateOptions how = options;
  how.notes = &notes;
  auto motions = generate_motions(model, timelines, how);
  std::vector<JudgedMotion> out(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const auto quality = motion_quality(motions[i]);
    out[i] = {.verdict = verdict(prompts[i], motions[i]),
              .positions = motions[i].positions(),
              .skate = quality.feet.speed,
              .jitter = quality.jitter,
              .bones = notes.layout == "smplrifke" ? bone_change(notes.features[i]) : 0};
    if (keep_motions) out[i].motion = std::move(motions[i]);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY Judgement judge(const MotionModel& model, std::vector<JudgedPrompt> prompts,
                                const GenerateOptions& options, int seeds, bool keep_motions,
                                const AnyCommunicator& all) {
  if (seeds < 1) raise<option_error>(101, "judge: ", seeds, " seeds");
  Judgement out;
  out.verdicts.resize(prompts.size());
  std::vector<Timeline> timelines;
  double length = 0;
  for (const JudgedPrompt& p : prompts) {
    timelines.push_back(p.timeline(model, options));
    length += p.seconds;
  }
  const auto take = [&](detail::JudgedMotion m, std::size_t prompt) {
    out.verdicts[prompt].push_back(std::move(m.verdict));
    out.positions.push_back(std::move(m.positions));
    out.skate += m.skate, out.jitter += m.jitter, out.bones += m.bones;
    if (keep_motions) out.made.push_back(std::move(m.motion));
  };
  // Each process has a seed of a round, and then all take the motions of the round in the order of seeds.
  const int processes = static_cast<int>(all.size()), rank = static_cast<int>(all.rank());
  for (int first = 0; first < seeds; first += processes) {
    const int together = std::min(processes, seeds - first);
    GenerateOptions how = options;
    how.seed = options.seed + static_cast<std::uint64_t>(first + rank);
    if (processes > 1) how.communicator = AnyCommunicator();  // a process makes the motions of its seed alone
    auto of_round = [&](Index done, Index total) {
      return options.progress(first * (total / together) + done, seeds * (total / together)), true;
    };
    std::vector<Index> work(static_cast<std::size_t>(processes));
    std::fill_n(work.begin(), together, 1);
    SharedProgress steps(all, std::move(work), of_round);
    how.progress = steps;
    const std::clock_t start = std::clock();
    std::vector<detail::JudgedMotion> mine;
    if (rank < together) mine = detail::judge_seed(model, prompts, timelines, how, keep_motions);
    steps.finish();
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / (length * seeds);
    if (processes == 1) {
      out.seconds += seconds;
      for (std::size_t i = 0; i < mine.size(); ++i) take(std::move(mine[i]), i);
      continue;
    }
    MessageWriter message;
    message.value(seconds);
    message.value(std::uint64_t{mine.size()});
    for (const detail::JudgedMotion& m : mine) detail::put_judged(message, m);
    for (const std::string& of_rank : messages_of_all(all, message.bytes())) {
      MessageReader in(of_rank);
      out.seconds += in.value<double>();
      const auto motions = static_cast<std::size_t>(in.value<std::uint64_t>());
      for (std::size_t i = 0; i < motions; ++i) take(detail::take_judged(in), i);
    }
  }
  for (double* sum : {&out.skate, &out.jitter, &out.bones})
    *sum /= static_cast<double>(std::max<std::size_t>(1, out.motions()));
  out.prompts = std::move(prompts);
  return out;
}

MOTIONLANG_BODY WarningShares warning_shares(const MotionModel& model, const Judgement& judgement) {
  WarningShares out;
  if (model.captions().empty()) return out;
  for (std::size_t i = 0; i < judgement.prompts.size(); ++i) {
    const auto& texts = judgement.prompts[i].texts;
    const bool warned = std::any_of(texts.begin(), texts.end(), [&](const JudgedText& t) {
      return !meaning_warnings(t.text, model.captions(), model.words()).empty();
    });
    const std::size_t done = judgement.done(i), failed = judgement.verdicts[i].size() - done;
    out.successes += done, out.failures += failed;
    (warned ? out.warned_successes : out.silent_failures) += static_cast<double>(warned ? done : failed);
  }
  out.silent_failures /= static_cast<double>(std::max<std::size_t>(1, out.failures));
  out.warned_successes /= static_cast<double>(std::max<std::size_t>(1, out.successes));
  return out;
}

MOTIONLANG_BODY KnownCaptions with_judged(const KnownCaptions& captions, std::span<const Judgement> judgements) {
  std::map<std::string, std::pair<double, double>> tried;  // done, all
  for (const Judgement& j : judgements) {
    for (std::size_t i = 0; i < j.prompts.size(); ++i) {
      const auto& texts = j.prompts[i].texts;
      if (texts.size() != 1 || !(texts[0].parts == BodyParts::all())) continue;
      auto& [done, all] = tried[texts[0].text];
      done += static_cast<double>(j.done(i)), all += static_cast<double>(j.verdicts[i].size());
    }
  }
  std::vector<std::string> texts;
  std::vector<double> shares;
  for (const auto& [text, counts] : tried) texts.push_back(text), shares.push_back(counts.first / counts.second);
  return captions.with_tried(texts, std::move(shares));
}

MOTIONLANG_BODY bool says(const JudgedVerb& verb, const std::string& caption) {
  return std::any_of(verb.said.begin(), verb.said.end(), [&](const std::string& s) {
    if (s.size() < 3 || s.front() != '*') return s == caption;
    const bool open = s.back() == '*';
    return caption.find(s.substr(1, s.size() - (open ? 2 : 1))) != std::string::npos;
  });
}

MOTIONLANG_BODY double mean_distance(const Judgement& a, const Judgement& b, std::size_t shift) {
  double sum = 0;
  std::size_t joints = 0;
  for (std::size_t i = 0; i + shift < a.motions(); ++i) {
    const auto &p = a.positions[i], &q = b.positions[i + shift];
    for (std::size_t j = 0; j < p.size(); ++j) sum += norm(p[j] - q[j]);
    joints += p.size();
  }
  return joints == 0 ? 0 : sum / static_cast<double>(joints);
}

MOTIONLANG_BODY const std::vector<JudgedBench>& judged_benches() {
  static const std::vector<JudgedBench> all{{"own", "what the bundled model was trained for",
                                             [](double seconds) {
                                               auto prompts = own_prompts();
                                               for (JudgedPrompt& p : prompts)
                                                 p.seconds = seconds > 0 ? seconds : p.seconds;
                                               return prompts;
                                             },
                                             0},
                                            {"newcomers", "what newcomers type", newcomers_prompts},
                                            {"arms", "an arm, the other, both over ten base movements", arm_prompts},
                                            {"trunk", "the head, the spine over ten base movements", trunk_prompts},
                                            {"paraphrases", "other words for the same", paraphrase_prompts}};
  return all;
}

MOTIONLANG_BODY std::vector<StepsCost> steps_costs(const MotionModel& model, const std::vector<JudgedPrompt>& prompts,
                                                   const GenerateOptions& options, std::span<const Index> steps,
                                                   int seeds, const std::function<void(const StepsCost&)>& on_row) {
  std::vector<StepsCost> rows;
  Judgement first;
  for (const Index count : steps) {
    GenerateOptions settings = options;
    settings.steps = count;
    Judgement j = judge(model, prompts, settings, seeds);
    if (rows.empty()) first = j;
    rows.push_back({.steps = count,
                    .done = static_cast<double>(j.done()) / static_cast<double>(j.motions()),
                    .skate = j.skate,
                    .jitter = j.jitter,
                    .bones = j.bones,
                    .away = mean_distance(first, j),
                    .seconds = j.seconds,
                    .seeds_apart = rows.empty() && seeds > 1 ? mean_distance(first, first, prompts.size()) : 0});
    if (on_row) on_row(rows.back());
  }
  return rows;
}

MOTIONLANG_NAMESPACE_END
