// motionlang judge: does the model do what prompts say? Each prompt is generated with several seeds and measured.
//
// What counts as done is stated in numbers per prompt (speed of the root, heights of hands and pelvis, turning), so that a table
// of percentages can be compared between models.
#include <cstdio>

#include <functional>
#include <numbers>

#include <motionlang/io/safetensors.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "generation.hpp"
#include "../commands.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

using ml::Index;

/// Measurements of a motion on the 24-joint skeleton. Metres, seconds, degrees.
struct Measures {
  double speed = 0;    // of the root over the floor, mean
  double forward = 0;  // net displacement along the first heading
  double turned = 0;   // net change of heading, positive to the left
  double lowest_pelvis = 9, last_pelvis = 0, first_pelvis = 0, highest_pelvis = 0;
  double left_hand = -9, right_hand = -9;            // highest wrist above its shoulder
  double both_hands = -9;                            // highest moment of the lower wrist above its shoulder
  double left_hand_speed = 0, right_hand_speed = 0;  // largest, relative to the pelvis
  double left_foot = 0, right_foot = 0;              // highest ankle above the standing height
  double both_feet = 0;                              // highest moment of the lower foot above the floor
  double first_head = 0, lowest_head = 9;
};

Measures measure(const ml::Motion& m) {
  Measures r;
  ml::JointTransforms<double> world;
  const Index n = m.frames();
  double floor = 9, path = 0, turned = 0, before = 0;
  std::vector<std::vector<ml::Vec3<double>>> frames;
  for (Index f = 0; f < n; ++f) {
    m.world(f, world);
    frames.push_back(world.position);
    for (const auto& p : world.position) floor = std::min(floor, p.y);
    const double heading = ml::detail::heading(m.rotations(f)[0]);
    if (f > 0) {
      turned += std::remainder(heading - before, 2 * std::numbers::pi);
      const auto d = m.root_at(f) - m.root_at(f - 1);
      path += std::hypot(d.x, d.z);
    }
    before = heading;
  }
  for (Index f = 0; f < n; ++f) {
    const auto& p = frames[static_cast<std::size_t>(f)];
    const double left = p[20].y - p[16].y, right = p[21].y - p[17].y;
    r.left_hand = std::max(r.left_hand, left);
    r.right_hand = std::max(r.right_hand, right);
    r.both_hands = std::max(r.both_hands, std::min(left, right));
    r.lowest_pelvis = std::min(r.lowest_pelvis, p[0].y - floor);
    r.highest_pelvis = std::max(r.highest_pelvis, p[0].y - floor);
    r.lowest_head = std::min(r.lowest_head, p[15].y - floor);
    r.left_foot = std::max(r.left_foot, p[7].y - floor);
    r.right_foot = std::max(r.right_foot, p[8].y - floor);
    r.both_feet = std::max(r.both_feet, std::min(p[10].y, p[11].y) - floor);
    if (f > 0) {
      const auto& q = frames[static_cast<std::size_t>(f) - 1];
      r.left_hand_speed = std::max(r.left_hand_speed, m.fps * ml::norm((p[20] - p[0]) - (q[20] - q[0])));
      r.right_hand_speed = std::max(r.right_hand_speed, m.fps * ml::norm((p[21] - p[0]) - (q[21] - q[0])));
    }
  }
  r.first_head = frames.front()[15].y - floor;
  r.first_pelvis = frames.front()[0].y - floor;
  r.last_pelvis = frames.back()[0].y - floor;
  r.speed = path / std::max(1e-9, static_cast<double>(n - 1) / m.fps);
  r.turned = turned * 180 / std::numbers::pi;
  const auto d = ml::rotate(ml::detail::turn(-ml::detail::heading(m.rotations(0)[0])), m.root_at(n - 1) - m.root_at(0));
  r.forward = d.z;
  return r;
}

struct Prompt {
  std::string text;
  double seconds;
  std::string rule;  // as the table prints it
  std::function<bool(const Measures&)> done;
};

/// What the free data show often: each of these is said about 19 segments or more (walking backwards) and up to 105 (bending).
const std::vector<Prompt>& prompts() {
  static const std::vector<Prompt> list{
      {"walk forward", 4, "goes > 2 m ahead at 0.5 to 1.9 m/s",
       [](const Measures& m) { return m.forward > 2 && m.speed > 0.5 && m.speed < 1.9; }},
      {"run forward", 3, "faster than 1.8 m/s", [](const Measures& m) { return m.speed > 1.8; }},
      {"walk backwards", 3, "goes > 0.6 m back", [](const Measures& m) { return m.forward < -0.6; }},
      {"walk slowly", 4, "0.25 to 1.1 m/s", [](const Measures& m) { return m.speed > 0.25 && m.speed < 1.1; }},
      {"stand still", 4, "slower than 0.15 m/s, pelvis stays up",
       [](const Measures& m) { return m.speed < 0.15 && m.lowest_pelvis > 0.75; }},
      {"turn left", 3, "turns > 45 degrees left", [](const Measures& m) { return m.turned > 45; }},
      {"turn right", 3, "turns > 45 degrees right", [](const Measures& m) { return m.turned < -45; }},
      {"raise both arms", 3, "both wrists > 0.15 m above the shoulders at once",
       [](const Measures& m) { return m.both_hands > 0.15; }},
      {"raise the right arm", 3, "only the right wrist > 0.1 m above its shoulder",
       [](const Measures& m) { return m.right_hand > 0.1 && m.left_hand < 0.1; }},
      {"sit down", 3, "pelvis ends > 0.2 m lower",
       [](const Measures& m) { return m.first_pelvis - m.last_pelvis > 0.2; }},
      {"jump forward", 2.5, "both feet > 0.1 m up, > 0.4 m ahead",
       [](const Measures& m) { return m.both_feet > 0.1 && m.forward > 0.4; }},
      {"bend forward", 3, "head comes > 0.25 m lower, pelvis stays above 0.6 m",
       [](const Measures& m) { return m.first_head - m.lowest_head > 0.25 && m.lowest_pelvis > 0.6; }},
  };
  return list;
}

struct Options {
  std::string model = default_model().string(), backend = "eigen";
  GenerationSettings settings;
  int seeds = 10;
  bool details = false;
};

void run(const Options& o) {
  const auto generator = load_generator(o.backend, model_file(o.model));
  std::vector<std::vector<Measures>> results(prompts().size());
  double skate = 0, shake = 0;
  {
    ProgressBar bar("judging");
    for (int seed = 0; seed < o.seeds; ++seed) {
      std::vector<ml::Timeline> timelines;
      for (const Prompt& p : prompts())
        timelines.push_back({{{p.text, 0, ml::frame_at(p.seconds, generator->fps()), ml::BodyParts::all()}}});
      GenerationSettings settings = o.settings;
      settings.seed = static_cast<std::uint64_t>(seed);
      auto steps = [&](ml::Index done, ml::Index total) { return bar(seed * total + done, o.seeds * total); };
      const auto motions = generator->run(timelines, settings, steps);
      for (std::size_t i = 0; i < motions.size(); ++i) {
        results[i].push_back(measure(motions[i]));
        const auto quality = ml::motion_quality(motions[i]);
        skate += quality.feet.speed;
        shake += quality.jitter;
      }
    }
  }
  std::printf("%-28s %-8s %s\n", "prompt", "done", "what counts");
  std::size_t all = 0, good = 0;
  for (std::size_t i = 0; i < prompts().size(); ++i) {
    std::size_t done = 0;
    for (const Measures& m : results[i]) done += prompts()[i].done(m) ? 1 : 0;
    std::printf("%-28s %zu/%-6zu %s\n", prompts()[i].text.c_str(), done, results[i].size(), prompts()[i].rule.c_str());
    if (o.details) {
      for (const Measures& m : results[i]) {
        std::printf(
            "    speed %.2f forward %+.2f turned %+4.0f pelvis %.2f>%.2f low %.2f hands L %+.2f R %+.2f both %+.2f "
            "speed %.1f head %.2f>%.2f feet %.2f %.2f both %.2f\n",
            m.speed, m.forward, m.turned, m.first_pelvis, m.last_pelvis, m.lowest_pelvis, m.left_hand, m.right_hand,
            m.both_hands, std::max(m.left_hand_speed, m.right_hand_speed), m.first_head, m.lowest_head, m.left_foot,
            m.right_foot, m.both_feet);
      }
    }
    good += done;
    all += results[i].size();
  }
  const double count = static_cast<double>(all);
  std::printf("%-28s %zu/%zu = %.0f %%\n", "all", good, all, 100.0 * static_cast<double>(good) / count);
  std::printf("foot skate %.3f m/s, jitter %.1f m/s^3 (means over all motions)\n", skate / count, shake / count);
  const auto about = ml::SafetensorsFile::open(model_file(o.model)).metadata();
  if (about.contains("real.skate") && about.contains("real.jitter")) {
    const double real_skate = std::stod(about.at("real.skate")), real_jitter = std::stod(about.at("real.jitter"));
    std::printf("recordings: %.3f m/s, %.1f m/s^3; ratio %.2f and %.2f\n", real_skate, real_jitter,
                skate / count / real_skate, shake / count / real_jitter);
  }
}

}  // namespace

void add_judge(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  CLI::App* c = app.add_subcommand(
      "judge",
      "Generates twelve prompts with several seeds, measures the motions, prints how many do what they should");
  c->add_option("--model", o->model, "Weights")->capture_default_str();
  c->add_option("--seeds", o->seeds, "Motions per prompt")->check(CLI::PositiveNumber)->capture_default_str();
  c->add_option("--guidance", o->settings.guidance, "Weight of the text, 1 is none; the model's own unless given")
      ->check(CLI::Range(0.0, 100.0));
  c->add_option("--steps", o->settings.steps, "Denoising steps; 0: all")->capture_default_str();
  c->add_option("--sampler", o->settings.sampler, "ddpm or ddim")
      ->check(CLI::IsMember({"ddpm", "ddim"}))
      ->capture_default_str();
  c->add_flag("--smooth,!--no-smooth", o->settings.smooth, "Takes trembling away; on unless switched off");
  c->add_flag("--fix-feet,!--no-fix-feet", o->settings.fix_feet, "Feet that stand do not slide; on unless switched off")
      ->capture_default_str();
  c->add_option("--backend", o->backend, "eigen, xtensor or reference")->capture_default_str();
  c->add_flag("--details", o->details, "Print the measurements of every motion");
  c->callback([o] { run(*o); });
}

}  // namespace program
