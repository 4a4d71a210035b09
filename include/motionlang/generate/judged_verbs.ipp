// SPDX-License-Identifier: MIT
// Bodies of judged_verbs.hpp.
#pragma once

#include <algorithm>  // count, max, min
#include <cmath>      // abs

#include <motionlang/generate/judged_verbs.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

using TracedValues = std::vector<double>;

inline double highest(const TracedValues& c) { return c.empty() ? 0 : *std::max_element(c.begin(), c.end()); }
inline double lowest(const TracedValues& c) { return c.empty() ? 0 : *std::min_element(c.begin(), c.end()); }
/// Mean over the first or the last quarter of a second.
inline double at_start(const MotionTrace& t, const TracedValues& c) {
  const auto n = std::min(c.size(), static_cast<std::size_t>(std::max(1.0, t.fps / 4)));
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += c[i] / static_cast<double>(n);
  return sum;
}
inline double at_end(const MotionTrace& t, const TracedValues& c) {
  return at_start(t, TracedValues(c.rbegin(), c.rend()));
}
inline double range(const TracedValues& c) { return highest(c) - lowest(c); }
/// One component of a curve of points.
template <class F>
TracedValues values_along(const std::vector<Vec3<double>>& points, F f) {
  TracedValues out;
  for (const auto& p : points) out.push_back(f(p));
  return out;
}
/// The smaller (larger) of two curves.
inline TracedValues lower_of(const TracedValues& a, const TracedValues& b) {
  TracedValues out;
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(std::min(a[i], b[i]));
  return out;
}
inline TracedValues higher_of(const TracedValues& a, const TracedValues& b) {
  TracedValues out;
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(std::max(a[i], b[i]));
  return out;
}

inline std::string said(const char* what, double value) { return concat_text(what, " ", two_digits(value)); }

/// The first reason that is not "".
inline std::string first_of(std::initializer_list<std::string> reasons) {
  for (const std::string& r : reasons) {
    if (!r.empty()) return r;
  }
  return "";
}
inline std::string between(const char* what, double value, double low, double high) {
  return value >= low && value <= high ? "" : said(what, value);
}
inline std::string above(const char* what, double value, double low) { return value > low ? "" : said(what, value); }
inline std::string below(const char* what, double value, double high) { return value < high ? "" : said(what, value); }

/// Metres per second along a direction of the first heading.
inline double pace(const MotionTrace& t, const TracedValues& way) {
  return t.frames() < 2 ? 0 : (way.back() - way.front()) / t.seconds();
}
/// Steps: the number of times that the feet pass each other.
inline std::size_t strides(const MotionTrace& t) {
  TracedValues apart;
  for (std::size_t f = 0; f < t.frames(); ++f) apart.push_back(t.legs[0].ahead[f] - t.legs[1].ahead[f]);
  return reversals(apart, 0.15);
}
/// At least this many in a second.
inline std::string steps(const MotionTrace& t, double least) {
  return above("steps/s", (static_cast<double>(strides(t)) + 1) / t.seconds(), least);
}
inline std::string upright(const MotionTrace& t) {
  return first_of({above("pelvis", lowest(t.pelvis), 0.7), below("lean", at_end(t, t.lean), 45)});
}
/// An action that happens once: at most once, or once more in every eight seconds.
inline std::string not_again(const MotionTrace& t, std::size_t times) {
  return times <= 1 + static_cast<std::size_t>(t.seconds() / 8.01) ? ""
                                                                   : concat_text("starts again: ", times, " times");
}

inline std::string walks(const MotionTrace& t, double slowest, double fastest) {
  const double way = std::hypot(t.forward.back() - t.forward.front(), t.left.back() - t.left.front()) / t.seconds();
  return first_of({between("speed", t.speed(), slowest, fastest), above("net speed", way, 0.5 * slowest), upright(t)});
}

/// An arm that is down, comes up, and is not lifted a second time.
inline std::string raises(const MotionTrace& t, std::size_t side, double high = 0.1) {
  const TracedValues& c = t.arms[side].raised;
  return first_of({below("arm starts at", at_start(t, c), 0), above("arm comes to", highest(c), high),
                   above("arm rises", highest(c) - at_start(t, c), 0.25), not_again(t, rises(c, -0.05, high))});
}
inline std::string stays_down(const MotionTrace& t, std::size_t side) {
  return below("other arm at", highest(t.arms[side].raised), 0.1);
}
inline std::string lowers(const MotionTrace& t, std::size_t side) {
  const TracedValues& c = t.arms[side].raised;
  return first_of({above("arm starts at", at_start(t, c), 0), below("arm ends at", at_end(t, c), -0.2)});
}
/// The side that f prefers: the one with no reason, or the right one.
template <class F>
std::string either(F f) {
  const std::string right = f(1);
  return right.empty() || f(0).empty() ? "" : right;
}

inline std::string goes_down(const MotionTrace& t, double by, double to_low, double to_high) {
  TracedValues down;
  for (const double y : t.pelvis) down.push_back(-y);
  return first_of({above("pelvis starts at", at_start(t, t.pelvis), 0.75),
                   above("pelvis falls", at_start(t, t.pelvis) - lowest(t.pelvis), by),
                   between("pelvis ends at", at_end(t, t.pelvis), to_low, to_high),
                   not_again(t, rises(down, -0.8, -at_start(t, t.pelvis) + by))});
}

inline std::string jumps(const MotionTrace& t, double peak, std::size_t most) {
  const auto all = flights(t, peak);
  if (all.empty()) return said("comes off the floor", highest(t.over_floor));
  double longest = 0;
  for (const Flight& f : all) longest = std::max(longest, f.seconds);
  if (longest < 0.15) return said("in the air s", longest);
  if (!all.back().lands) return "does not land";
  return all.size() > most ? concat_text("starts again: ", all.size(), " jumps") : "";
}
inline std::size_t jumps_in(const MotionTrace& t) { return 1 + static_cast<std::size_t>(t.seconds() / 3); }

inline std::string turns(double degrees, double least, double most) { return between("turned", degrees, least, most); }

inline std::string waves(const MotionTrace& t, std::size_t side) {
  const ArmTrace& a = t.arms[side];
  TracedValues when_up;
  for (std::size_t f = 0; f < t.frames(); ++f) {
    if (a.raised[f] > -0.15) when_up.push_back(a.hand[f].x);
  }
  return above("swings of the raised hand", static_cast<double>(reversals(when_up, 0.08)), 1);
}
inline std::string punches(const MotionTrace& t, std::size_t side) {
  const ArmTrace& a = t.arms[side];
  const TracedValues ahead = values_along(a.hand, [](const auto& p) { return p.z; });
  return first_of({above("hand comes ahead", highest(ahead), 0.3), above("hand speed", highest(a.speed), 2),
                   above("hand at", highest(a.raised), -0.25), below("hand starts ahead", at_start(t, ahead), 0.35)});
}
inline std::string kicks(const MotionTrace& t, std::size_t side) {
  const LegTrace& l = t.legs[side];
  return first_of({above("foot comes to", highest(l.height), 0.3), above("foot speed", highest(l.speed), 2),
                   above("foot comes ahead", highest(l.ahead), 0.35), below("foot ends at", at_end(t, l.height), 0.1),
                   not_again(t, rises(l.height, 0.08, 0.3))});
}
inline std::string moves_arms_and_legs(const MotionTrace& t, double arms, double legs) {
  const auto mean = [](const TracedValues& a) {
    double sum = 0;
    for (const double v : a) sum += v / static_cast<double>(a.size());
    return sum;
  };
  return first_of({above("hand speed", std::max(mean(t.arms[0].speed), mean(t.arms[1].speed)), arms),
                   above("foot speed", std::max(mean(t.legs[0].speed), mean(t.legs[1].speed)), legs)});
}

inline std::vector<JudgedVerb> make_verbs() {
  using T = const MotionTrace&;
  const auto more = [](std::string a, std::string b) { return first_of({std::move(a), std::move(b)}); };
  std::vector<JudgedVerb> v{
      {"walk",
       "goes ahead at 0.5 to 1.9 m/s, step by step, on the floor",
       [](T t) {
         return first_of({walks(t, 0.5, 1.9), above("ahead m/s", pace(t, t.forward), 0.3), steps(t, 0.8)});
       },
       false,
       {"walk forward", "walk straight ahead", "walk straight", "walk along", "a person walks forward"}},
      {"walk anywhere", "walks at 0.3 to 1.9 m/s, step by step",
       [](T t) {
         return first_of({between("speed", t.speed(), 0.3, 1.9), upright(t), steps(t, 0.6)});
       }},
      {"walk slowly",
       "goes ahead at 0.2 to 1.1 m/s",
       [](T t) {
         return first_of({walks(t, 0.2, 1.1), above("ahead m/s", pace(t, t.forward), 0.1)});
       },
       false,
       {"walk slowly", "a person walks slowly", "walk slowly straight ahead"}},
      {"walk backwards",
       "goes back at 0.3 m/s or more, step by step",
       [](T t) {
         return first_of({below("back m/s", pace(t, t.forward), -0.3), between("speed", t.speed(), 0.3, 2.0),
                          upright(t), steps(t, 0.6)});
       },
       false,
       {"walk backwards", "a person walks backwards", "walking backwards"}},
      {"walk to the left", "goes 0.15 m/s or more to the left",
       [](T t) {
         return first_of({above("left m/s", pace(t, t.left), 0.15), upright(t)});
       }},
      {"walk to the right", "goes 0.15 m/s or more to the right",
       [](T t) {
         return first_of({below("left m/s", pace(t, t.left), -0.15), upright(t)});
       }},
      {"walk in a circle", "walks, and turns 60 degrees in a second of walking or 270 in all",
       [](T t) {
         return first_of({between("speed", t.speed(), 0.3, 1.9), upright(t),
                          above("turned", std::abs(t.turned()), std::min(270.0, 45 * t.seconds()))});
       }},
      {"run",
       "goes ahead faster than 1.8 m/s",
       [](T t) {
         return first_of(
             {above("ahead m/s", pace(t, t.forward), 1.8), below("speed", t.speed(), 7), steps(t, 1.2), upright(t)});
       },
       false,
       {"run forward", "a person runs forward", "run", "sprint forward", "run straight ahead"}},
      {"jog",
       "goes ahead faster than 1.3 m/s",
       [](T t) {
         return first_of(
             {above("ahead m/s", pace(t, t.forward), 1.3), below("speed", t.speed(), 5), steps(t, 1.2), upright(t)});
       },
       false,
       {"jog", "jogging", "a person jogs", "jog forward"}},
      {"stand",
       "slower than 0.15 m/s, upright, hands down, turns less than 45 degrees",
       [](T t) {
         return first_of({below("speed", t.speed(), 0.15), upright(t), below("turned", std::abs(t.turned()), 45),
                          below("hands at", highest(lower_of(t.arms[0].raised, t.arms[1].raised)), 0.1)});
       },
       true,
       {"stand still", "stand quietly", "stand and wait", "a person stands still", "stay in place", "be idle"}},
      {"stand with free arms", "slower than 0.15 m/s, upright, turns less than 45 degrees",
       [](T t) {
         return first_of({below("speed", t.speed(), 0.15), upright(t), below("turned", std::abs(t.turned()), 45)});
       },
       true},
      {"turn left",
       "turns 45 to 200 degrees to the left",
       [](T t) {
         return first_of({turns(t.turned(), 45, 200), upright(t)});
       },
       false,
       {"turn left", "turn to the left", "a person turns left", "turning around to the left",
        "turn around to the left"}},
      {"turn right",
       "turns 45 to 200 degrees to the right",
       [](T t) {
         return first_of({turns(-t.turned(), 45, 200), upright(t)});
       },
       false,
       {"turn right", "turn to the right", "a person turns right", "turning around to the right",
        "turn around to the right"}},
      {"turn around",
       "turns 120 to 240 degrees",
       [](T t) {
         return first_of({turns(std::abs(t.turned()), 120, 240), upright(t)});
       },
       false,
       {"turn around", "a person turns around"}},
      {"spin", "turns 300 degrees or more",
       [](T t) {
         return first_of({above("turned", std::abs(t.turned()), 300), upright(t)});
       }},
      {"raise both arms",
       "both wrists come from below to 0.1 m above the shoulders, at once and once",
       [](T t) {
         const TracedValues both = lower_of(t.arms[0].raised, t.arms[1].raised);
         return first_of(
             {below("an arm starts at", std::max(at_start(t, t.arms[0].raised), at_start(t, t.arms[1].raised)), 0),
              above("arms come to", highest(both), 0.1), not_again(t, rises(both, -0.05, 0.1))});
       },
       false,
       {"raise both arms", "raising both arms", "raise both hands", "raising both hands", "lift both arms",
        "raise both arms above the head", "a person raises both arms"}},
      {"raise the right arm",
       "the right wrist comes from below to 0.1 m above its shoulder, once; the left stays below",
       [](T t) {
         return first_of({raises(t, 1), stays_down(t, 0)});
       },
       false,
       {"raise the right arm", "raise the right hand", "lift the right arm", "a person raises the right arm"}},
      {"raise the left arm",
       "the left wrist comes from below to 0.1 m above its shoulder, once; the right stays below",
       [](T t) {
         return first_of({raises(t, 0), stays_down(t, 1)});
       },
       false,
       {"raise the left arm", "raise the left hand", "lift the left arm", "a person raises the left arm"}},
      {"raise an arm", "a wrist comes from below to 0.1 m above its shoulder",
       [](T t) { return either([&](std::size_t s) { return raises(t, s); }); }},
      {"lower both arms",
       "both wrists come from the shoulders down",
       [](T t) {
         return first_of({lowers(t, 0), lowers(t, 1)});
       },
       false,
       {"lower both arms", "lowering both arms", "move both arms down", "taking both arms down",
        "bring both hands down"}},
      {"sit down",
       "stands, comes 0.2 m lower, stays there",
       [](T t) {
         return first_of(
             {goes_down(t, 0.2, 0.05, 0.75), below("gets up again", at_end(t, t.pelvis) - lowest(t.pelvis), 0.12)});
       },
       false,
       {"sit down", "a person sits down", "sitting down", "sit down on a stool", "sit on a high stool"}},
      {"stand up",
       "pelvis begins low and ends 0.15 m higher, standing",
       [](T t) {
         return first_of({above("pelvis rises", at_end(t, t.pelvis) - at_start(t, t.pelvis), 0.15),
                          above("pelvis ends at", at_end(t, t.pelvis), 0.8)});
       },
       false,
       {"stand up", "a person stands up", "get up", "rise from the stool", "standing up"}},
      {"squat",
       "pelvis falls 0.25 m, feet stay",
       [](T t) {
         return first_of({above("pelvis starts at", at_start(t, t.pelvis), 0.75),
                          above("pelvis falls", at_start(t, t.pelvis) - lowest(t.pelvis), 0.25),
                          below("speed", t.speed(), 0.4)});
       },
       false,
       {"squat", "squat down", "squatting", "a person squats"}},
      {"crouch",
       "pelvis falls 0.2 m or stays low",
       [](T t) { return below("pelvis", lowest(t.pelvis), 0.72); },
       false,
       {"crouch", "crouch down", "a person crouches"}},
      {"kneel", "a knee comes to the floor",
       [](T t) {
         return first_of({below("knee", lowest(lower_of(t.legs[0].knee, t.legs[1].knee)), 0.2),
                          below("pelvis", lowest(t.pelvis), 0.7)});
       }},
      {"lie down", "pelvis and head end below 0.35 and 0.45 m",
       [](T t) {
         return first_of(
             {below("pelvis ends at", at_end(t, t.pelvis), 0.35), below("head ends at", at_end(t, t.head), 0.45)});
       },
       true},
      {"fall", "pelvis and head end below 0.5 and 0.7 m",
       [](T t) {
         return first_of(
             {below("pelvis ends at", at_end(t, t.pelvis), 0.5), below("head ends at", at_end(t, t.head), 0.7)});
       }},
      {"crawl", "goes ahead with hands and pelvis low",
       [](T t) {
         return first_of({below("pelvis", at_end(t, t.pelvis), 0.75),
                          below("hands", lowest(higher_of(t.arms[0].above_floor, t.arms[1].above_floor)), 0.3),
                          above("ahead m/s", pace(t, t.forward), 0.08)});
       }},
      {"sneak", "goes ahead slowly, bent or with low hips",
       [](T t) {
         return first_of(
             {between("speed", t.speed(), 0.1, 1.2), above("ahead m/s", pace(t, t.forward), 0.08),
              above("hips lower or trunk bent", (0.93 - lowest(t.pelvis)) / 0.08 + highest(t.lean) / 25, 1)});
       }},
      {"jump",
       "both feet leave the floor by 0.08 m, and it lands",
       [](T t) { return jumps(t, 0.08, jumps_in(t)); },
       false,
       {"jump up", "jump", "a person jumps up", "jump straight up", "jump up high"}},
      {"jump forward",
       "leaves the floor by 0.08 m, lands 0.3 m further on",
       [more](T t) { return more(jumps(t, 0.08, jumps_in(t)), above("ahead", t.forward.back(), 0.3)); },
       false,
       {"jump forward", "a person jumps forward", "jumping forward", "jumping a long way", "leap forward"}},
      {"hop",
       "leaves the floor by 5 cm, and it lands",
       [](T t) { return jumps(t, 0.055, 100); },
       false,
       {"hop on the right foot", "hop on the left foot", "hopping on the right foot"}},
      {"skip", "goes ahead and leaves the floor twice",
       [more](T t) {
         return more(above("flights", static_cast<double>(flights(t, 0.055).size()), 1),
                     above("ahead m/s", pace(t, t.forward), 0.4));
       }},
      {"jumping jack", "jumps while both arms come up",
       [more](T t) {
         return more(jumps(t, 0.055, 100),
                     above("arms come to", highest(lower_of(t.arms[0].raised, t.arms[1].raised)), 0.1));
       }},
      {"bend forward",
       "the trunk bends 40 degrees, once; pelvis stays above 0.55 m",
       [](T t) {
         return first_of({below("starts bent by", at_start(t, t.lean), 35), above("bends by", highest(t.lean), 40),
                          above("pelvis", lowest(t.pelvis), 0.55), not_again(t, rises(t.lean, 25, 40))});
       },
       false,
       {"bend forward", "bend over", "bend down", "a person bends forward", "bending forward", "lean forward"}},
      {"bow", "the trunk bends 20 degrees and comes up again",
       [](T t) {
         return first_of({above("bends by", highest(t.lean), 20), below("ends bent by", at_end(t, t.lean), 25),
                          above("pelvis", lowest(t.pelvis), 0.7)});
       }},
      {"pick up", "a hand comes below 0.45 m, the body comes up again",
       [](T t) {
         return first_of({below("hands", lowest(lower_of(t.arms[0].above_floor, t.arms[1].above_floor)), 0.45),
                          above("head ends at", at_end(t, t.head), 1.2)});
       }},
      {"wave",
       "a raised hand swings sideways twice or more",
       [](T t) { return either([&](std::size_t s) { return waves(t, s); }); },
       false,
       {"wave", "*wave with*", "wave a hand", "*waving with*"}},
      {"wave right", "the raised right hand swings sideways twice or more", [](T t) { return waves(t, 1); }},
      {"clap", "the hands come together and apart twice or more",
       [](T t) {
         return first_of({below("hands apart", lowest(t.hands_apart), 0.25),
                          above("claps", static_cast<double>(reversals(t.hands_apart, 0.1)), 2)});
       }},
      {"point", "one arm is stretched at the height of the shoulder",
       [](T t) {
         return either([&](std::size_t s) {
           TracedValues best;
           for (std::size_t f = 0; f < t.frames(); ++f)
             best.push_back(std::abs(t.arms[s].raised[f]) < 0.25 && t.arms[s].hand[f].z > 0.25 ? t.arms[s].elbow[f]
                                                                                               : 0);
           return first_of({above("elbow", highest(best), 140), stays_down(t, 1 - s)});
         });
       }},
      {"punch",
       "a hand comes from the body and ahead faster than 2 m/s",
       [](T t) { return either([&](std::size_t s) { return punches(t, s); }); },
       false,
       {"*punch*"}},
      {"kick",
       "a foot comes ahead and up faster than 2 m/s, and down again",
       [](T t) { return either([&](std::size_t s) { return kicks(t, s); }); },
       false,
       {"kick", "kick a ball", "*kick with*", "*kicks a*"}},
      {"throw", "a hand comes ahead faster than 3 m/s",
       [](T t) {
         return either([&](std::size_t s) {
           return first_of({above("hand speed", highest(t.arms[s].speed), 3),
                            above("hand moves ahead",
                                  range(values_along(t.arms[s].hand, [](const auto& p) { return p.z; })), 0.35)});
         });
       }},
      {"push", "both hands come ahead of the chest",
       [](T t) {
         const auto z = [](const Vec3<double>& p) { return p.z; };
         return first_of(
             {above("hands come ahead",
                    highest(lower_of(values_along(t.arms[0].hand, z), values_along(t.arms[1].hand, z))), 0.33),
              above("hands at", highest(lower_of(t.arms[0].raised, t.arms[1].raised)), -0.4)});
       }},
      {"hand to the head", "a hand comes within 0.28 m of the head, once or more",
       [](T t) {
         return either([&](std::size_t s) {
           return first_of({below("hand from the head", lowest(t.arms[s].to_mouth), 0.28),
                            above("hand starts from the head", at_start(t, t.arms[s].to_mouth), 0.4)});
         });
       }},
      {"dance", "arms and legs move",
       [](T t) {
         return first_of({moves_arms_and_legs(t, 0.4, 0.35), above("pelvis", lowest(t.pelvis), 0.5)});
       }},
      {"box", "hands come ahead of the body again and again",
       [](T t) {
         std::size_t n = 0;
         for (const ArmTrace& a : t.arms)
           n += rises(values_along(a.hand, [](const auto& p) { return p.z; }), 0.33, 0.4);
         return first_of({above("punches", static_cast<double>(n), 1),
                          above("hand speed", std::max(highest(t.arms[0].speed), highest(t.arms[1].speed)), 1.8)});
       }},
      {"march", "knees come up to 0.65 m in turn",
       [](T t) {
         return first_of(
             {above("left knee", highest(t.legs[0].knee), 0.62), above("right knee", highest(t.legs[1].knee), 0.62),
              above("times", static_cast<double>(rises(t.legs[0].knee, 0.55, 0.6) + rises(t.legs[1].knee, 0.55, 0.6)),
                    1)});
       }},
      {"stretch", "a hand comes 0.2 m above its shoulder",
       [](T t) { return above("hands come to", highest(higher_of(t.arms[0].raised, t.arms[1].raised)), 0.2); }},
      {"nod", "the head goes down and up by 8 degrees twice",
       [](T t) { return above("nods", static_cast<double>(reversals(t.look_up, 8)), 1); }},
      {"shake the head", "the head turns by 12 degrees to and fro",
       [](T t) { return above("turns of the head", static_cast<double>(reversals(t.look_left, 12)), 1); }},
      {"look left", "the head turns 20 degrees to the left",
       [](T t) {
         TracedValues gaze;
         for (std::size_t f = 0; f < t.frames(); ++f) gaze.push_back(t.look_left[f] + t.twist[f]);
         return above("looks left by", highest(gaze) - at_start(t, gaze), 20);
       }},
      {"look around", "the head turns 20 degrees to either side",
       [](T t) {
         TracedValues gaze;
         for (std::size_t f = 0; f < t.frames(); ++f) gaze.push_back(t.look_left[f] + t.twist[f]);
         return above("looks about by", range(gaze), 40);
       }},
      {"twist", "the chest turns 20 degrees against the pelvis",
       [](T t) { return above("twists by", range(t.twist), 20); }},
      {"swing the arms", "a hand swings 0.3 m ahead and back",
       [](T t) {
         return either([&](std::size_t s) {
           return above(
               "swings",
               static_cast<double>(reversals(values_along(t.arms[s].hand, [](const auto& p) { return p.z; }), 0.25)),
               1);
         });
       }},
      {"lunge", "the feet come 0.6 m apart, the pelvis 0.15 m down",
       [](T t) {
         TracedValues apart;
         for (std::size_t f = 0; f < t.frames(); ++f)
           apart.push_back(std::abs(t.legs[0].ahead[f] - t.legs[1].ahead[f]));
         return first_of({above("feet apart", highest(apart), 0.6), below("pelvis", lowest(t.pelvis), 0.8)});
       }},
      {"lift a leg", "a foot stays 0.2 m up for half a second while the other stands",
       [](T t) {
         return either([&](std::size_t s) {
           std::size_t n = 0;
           for (std::size_t f = 0; f < t.frames(); ++f)
             n += t.legs[s].height[f] > 0.15 && t.legs[1 - s].height[f] < 0.05;
           return above("seconds on one foot", static_cast<double>(n) / t.fps, 0.5);
         });
       }},
      {"cross the arms", "each hand lies on the other side of the chest",
       [](T t) {
         TracedValues crossed;
         for (std::size_t f = 0; f < t.frames(); ++f) crossed.push_back(t.arms[1].hand[f].x - t.arms[0].hand[f].x);
         return above("hands crossed by", highest(crossed), 0);
       }},
      {"zombie", "walks with both arms held ahead",
       [](T t) {
         const auto z = [](const Vec3<double>& p) { return p.z; };
         return first_of(
             {between("speed", t.speed(), 0.15, 1.6),
              above("hands ahead",
                    at_end(t, lower_of(values_along(t.arms[0].hand, z), values_along(t.arms[1].hand, z))), 0.25),
              above("hands at", at_end(t, lower_of(t.arms[0].raised, t.arms[1].raised)), -0.3)});
       }},
      {"flip", "the pelvis comes above the head in the air, and it stands again",
       [](T t) {
         return first_of({above("pelvis above the head", highest(t.upside_down), 0.1),
                          above("head ends at", at_end(t, t.head), 1.2)});
       }},
  };
  return v;
}

}  // namespace detail

MOTIONLANG_BODY const std::vector<JudgedVerb>& judged_verbs() {
  static const std::vector<JudgedVerb> list = detail::make_verbs();
  return list;
}

MOTIONLANG_BODY const JudgedVerb* known_verb(std::string_view name) {
  for (const JudgedVerb& v : judged_verbs()) {
    if (v.name == name) return &v;
  }
  return nullptr;
}

MOTIONLANG_BODY const JudgedVerb& find_verb(std::string_view name) {
  if (const JudgedVerb* verb = known_verb(name)) return *verb;
  raise<config_error>(103, "find_verb: '", name, "' is not a judged verb");
}

MOTIONLANG_BODY std::string why_not_done(const JudgedVerb& verb, const MotionTrace& trace, const EyeLimits& limits) {
  if (trace.frames() < 2) return "too short";
  if (std::string wrong = look_wrong(trace, limits); !wrong.empty()) return wrong;
  if (const double still = still_share(trace); !verb.rests && still > limits.still)
    return detail::said("stands like a statue, share", still);
  return verb.why_not(trace);
}

MOTIONLANG_NAMESPACE_END
