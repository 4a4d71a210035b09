// BVH files as people have them: what stands beside the body, rows too many or too few, other encodings of text and
// numbers, names, other axes. Positions are compared with a calculation of their own by 4 x 4 matrices.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <motionlang/core/rng.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/kinematics/up_axis.hpp>

#include "../../support/rigs.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

std::filesystem::path fault(const std::string& name) {
  return std::filesystem::path(tests_folder()) / "unit/formats/data" / name;
}

void check_equal(const ml::Vec3<double>& a, const ml::Vec3<double>& b, double tolerance = 1e-5) {
  CHECK_MESSAGE(ml::norm(a - b) < tolerance, a.x, " ", a.y, " ", a.z, " and ", b.x, " ", b.y, " ", b.z);
}
ml::Vec3<double> travel(const ml::Motion& m) { return m.root.back() - m.root.front(); }

std::string with(std::string text, std::string_view what, std::string_view instead) {
  const auto at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), instead);
}

using Matrix = std::array<std::array<double, 4>, 4>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}
Matrix identity() {
  Matrix m{};
  for (std::size_t i = 0; i < 4; ++i) m[i][i] = 1;
  return m;
}
Matrix turn(std::size_t axis, double degrees) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  Matrix m = identity();
  m[u][u] = m[v][v] = c, m[u][v] = -s, m[v][u] = s;
  return m;
}

/// A file that is made at random: nodes with channels, and the world matrices of its frames.
class RandomFile {
 public:
  struct Node {
    std::string name, parent;
    std::array<double, 3> offset;
    std::string channels;  // "xyzZXY": small letters are positions
  };
  std::vector<Node> nodes;
  std::vector<std::vector<double>> rows;

  std::string text(const std::string& frames) const {
    std::string out = "HIERARCHY\n";
    write(out, 0, "ROOT");
    out += "MOTION\nFrames: " + frames + "\nFrame Time: 0.05\n";
    for (const auto& row : rows) {
      for (const double v : row) out += std::to_string(v) + " ";
      out += '\n';
    }
    return out;
  }
  std::size_t columns() const {
    std::size_t n = 0;
    for (const Node& node : nodes) n += node.channels.size();
    return n;
  }
  /// World positions in a frame, by name, from numbers as they are printed.
  std::map<std::string, ml::Vec3<double>> positions(std::size_t frame) const {
    std::map<std::string, Matrix> world;
    std::map<std::string, ml::Vec3<double>> out;
    std::map<std::string, std::size_t> first;
    place(0, first, 0);
    for (const Node& n : nodes) {
      Matrix m = identity();
      for (std::size_t i = 0; i < 3; ++i) m[i][3] = printed(n.offset[i]);
      std::size_t at = first.at(n.name);
      Matrix r = identity();
      for (const char c : n.channels) {
        const double v = printed(rows[frame][at++]);
        if (c >= 'x') m[static_cast<std::size_t>(c - 'x')][3] = v;
        if (c <= 'Z') r = product(r, turn(static_cast<std::size_t>(c - 'X'), v));
      }
      const Matrix above = n.parent.empty() ? identity() : world.at(n.parent);
      const Matrix here = world[n.name] = product(above, product(m, r));
      out[n.name] = {here[0][3], here[1][3], here[2][3]};
    }
    return out;
  }
  /// Columns of the file: depth first.
  std::size_t place(std::size_t node, std::map<std::string, std::size_t>& first, std::size_t at) const {
    first[nodes[node].name] = at;
    at += nodes[node].channels.size();
    for (std::size_t c = 0; c < nodes.size(); ++c)
      if (nodes[c].parent == nodes[node].name) at = place(c, first, at);
    return at;
  }

 private:
  static double printed(double v) { return std::stod(std::to_string(v)); }
  void write(std::string& out, std::size_t node, const std::string& kind) const {
    const Node& n = nodes[node];
    out += kind + " " + n.name + "\n{\nOFFSET";
    for (const double v : n.offset) out += " " + std::to_string(v);
    out += "\nCHANNELS " + std::to_string(n.channels.size());
    for (const char c : n.channels)
      out +=
          std::string(" ") + (c >= 'x' ? static_cast<char>(c - 'x' + 'X') : c) + (c >= 'x' ? "position" : "rotation");
    out += '\n';
    for (std::size_t c = 0; c < nodes.size(); ++c)
      if (nodes[c].parent == n.name) write(out, c, "JOINT");
    out += "}\n";
  }
};

/// A figure with the names of a table that walks under nodes that move as well, with other joints beside it.
RandomFile walk_among_others(const ml::SkeletonTable& table, ml::Philox& draw) {
  ml::Skeleton figure = rigs::skeleton_of(table, 0, 100);
  for (std::string& name : figure.names) std::replace(name.begin(), name.end(), ' ', '_');  // as in "L Thigh"
  const auto number = [&](double size) { return size * (2 * draw.uniform() - 1); };
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(draw.uniform() * static_cast<double>(n)); };
  const auto rotations = [&] { return std::array{"ZXY", "ZYX", "XYZ", "YXZ", "XZY", "YZX"}[pick(6)]; };
  RandomFile file;
  std::vector<std::string> above;
  const auto carrier = [&](const std::string& name, std::string channels) {
    file.nodes.push_back(
        {name, above.empty() ? "" : above.back(), {number(30), number(30), number(30)}, std::move(channels)});
    above.push_back(name);
  };
  carrier("stage", draw.uniform() < 0.5 ? "xyzZXY" : "");
  for (std::size_t i = 0, n = pick(3); i < n; ++i) carrier("carrier" + std::to_string(i), i % 2 == 0 ? "yxzYXZ" : "Y");
  const auto beside = [&](int k) {
    const std::string name = "ik" + std::to_string(k);
    file.nodes.push_back({name, above[pick(above.size())], {number(50), number(50), number(50)}, "xyzZXY"});
    file.nodes.push_back({name + "_end", name, {number(50), number(50), number(50)}, rotations()});
  };
  const int others = static_cast<int>(pick(4));
  for (int k = 0; k < others / 2; ++k) beside(k);
  for (int j = 1; j < figure.size(); ++j) {
    const auto& o = figure.offset(j);
    const bool hips = j == 1;
    // below the hips, some programs repeat the offset as positions
    const std::string channels = (hips || draw.uniform() < 0.3 ? "xyz" : "") + std::string(rotations());
    file.nodes.push_back(
        {figure.name(j), hips ? above.back() : figure.name(figure.parent(j)), {o.x, o.y, o.z}, channels});
  }
  for (int k = others / 2; k < others; ++k) beside(k);
  std::map<std::string, std::size_t> first;
  file.rows.assign(4, std::vector<double>(file.columns()));
  file.place(0, first, 0);
  for (std::size_t f = 0; f < file.rows.size(); ++f) {
    for (const RandomFile::Node& n : file.nodes) {
      std::size_t at = first.at(n.name);
      const bool moves =
          n.name == figure.name(1) || n.name.starts_with("ik") || n.name == "stage" || n.name.starts_with("carrier");
      for (const char c : n.channels) {
        const double still = c >= 'x' ? n.offset[static_cast<std::size_t>(c - 'x')] : 0;
        file.rows[f][at++] = c >= 'x' ? (moves ? number(200) : still) : number(40);
      }
    }
  }
  return file;
}

}  // namespace

TEST_CASE("BVH: the path of a pelvis with IK bones beside it is kept, and these are not joints") {
  std::string notes;
  const ml::Motion m = ml::read_motion(fault("bvh_root_with_ik_bones.bvh"), {}, &notes);
  CHECK(m.skeleton.name(0) == "pelvis");
  CHECK(m.skeleton.find("ik_foot_root") == -1);
  check_equal(travel(m), {0.12666667, 0, 0.76});
  CHECK_MESSAGE(notes.find(": left out: 'ik_foot_root' beside 'pelvis', the root of the body\n") != notes.npos, notes);
  CHECK(notes.find("away from the joint before") == notes.npos);
  const TemporaryFolder folder;
  ml::write_motion(folder / "out.npz", m);
  check_equal(travel(ml::read_motion(folder / "out.npz")), {0.1237, 0, 0.7419}, 1e-4);
  ml::write_motion(folder / "out.bvh", m);
  check_equal(travel(ml::read_motion(folder / "out.bvh")), {0.12666667, 0, 0.76});
}

TEST_CASE("BVH: whatever stands above and beside a body, its joints are where the file has them") {
  ml::Philox draw{.seed = 11};
  int files = 0;
  for (int i = 0; i < 240; ++i) {
    const auto& tables = ml::skeleton_tables();
    const ml::SkeletonTable& table = tables[static_cast<std::size_t>(i) % tables.size()];
    if (table.find("left_wrist") == nullptr || ml::find_skeleton_table(rigs::skeleton_of(table)) == nullptr)
      continue;  // rigs have a thumb there, and one joint for each of SMPL's
    ++files;
    const RandomFile file = walk_among_others(table, draw);
    CAPTURE(i);
    CAPTURE(table.name);
    const ml::Bvh bvh = ml::parse_bvh(file.text("4"));
    const ml::Motion m = ml::to_motion(bvh);
    CHECK(ml::stretched_joints(bvh).empty());
    CHECK(m.skeleton.name(0) == ml::find_skeleton_table(m.skeleton)->find("pelvis")->source);
    for (const std::string& name : m.skeleton.names) CHECK(!name.starts_with("ik"));
    const auto p = m.positions();
    for (std::size_t f = 0; f < 4; ++f) {
      const auto wanted = file.positions(f);
      for (int j = 0; j < m.skeleton.size(); ++j) {
        const auto& there = p[f * static_cast<std::size_t>(m.skeleton.size()) + static_cast<std::size_t>(j)];
        CHECK(ml::norm(there - 0.01 * wanted.at(m.skeleton.name(j))) < 1e-5);
      }
    }
    // and once more after being written
    const ml::Motion again = ml::to_motion(ml::to_bvh(m));
    const auto q = again.positions();
    for (std::size_t k = 0; k < p.size(); ++k) {
      const auto joints = static_cast<std::size_t>(m.skeleton.size());
      const auto other = static_cast<std::size_t>(again.skeleton[m.skeleton.names[k % joints]]);
      CHECK(ml::norm(p[k] - q[k / joints * joints + other]) < 1e-5);
    }
  }
  CHECK(files > 100);
}

TEST_CASE("BVH: where a path is left out all the same, the note says so") {
  // Two halves of a figure without known names move at once.
  const std::string text =
      "HIERARCHY ROOT a { OFFSET 0 0 0 JOINT b { OFFSET 0 1 0 CHANNELS 4 Xposition Yposition Zposition Zrotation JOINT "
      "c "
      "{ OFFSET 0 1 0 JOINT d { OFFSET 0 1 0 JOINT d2 { OFFSET 0 1 0 } } } } JOINT e { OFFSET 1 0 0 CHANNELS 1 "
      "Zrotation } } MOTION\n"
      "Frames: 2\nFrame Time: 0.05\n0 1 0 0 0\n0.5 1 0 0 30\n";
  const TemporaryFolder folder;
  ml::write_file(folder / "half.bvh", text);
  std::string notes;
  ml::read_motion(folder / "half.bvh", {}, &notes);
  CHECK_MESSAGE(notes.find("left out: how 'b' moves away from the joint before") != notes.npos, notes);
  CHECK_MESSAGE(notes.find("with that the walk is lost: 'b' carries 3 of the 6 joints") != notes.npos, notes);
}

TEST_CASE("BVH: beside a body, a ROOT with few joints is a prop and left out with a note") {
  auto walk = synthetic::walk({.frames = 2});
  std::string text = ml::format_bvh(ml::to_bvh(walk));
  const auto motion = text.find("MOTION");
  text.insert(motion, "ROOT camera\n{\n\tOFFSET 0 0 0\n\tCHANNELS 3 Xposition Yposition Zposition\n}\n");
  std::string rows;
  std::size_t at = text.find('\n', text.find("Frame Time")) + 1;
  for (std::size_t end = text.find('\n', at); end != text.npos; at = end + 1, end = text.find('\n', at))
    rows += text.substr(at, end - at) + " 7 8 9\n";
  text.resize(text.find('\n', text.find("Frame Time")) + 1);
  const TemporaryFolder folder;
  ml::write_file(folder / "two.bvh", text + rows);
  std::string notes;
  const ml::Motion m = ml::read_motion(folder / "two.bvh", {}, &notes);
  CHECK(m.skeleton.size() == 24);
  CHECK_MESSAGE(notes.find("left out: ROOT 'camera' with 1 joint, which is not a body") != notes.npos, notes);
}

TEST_CASE("BVH: a row more than declared is left out with a note") {
  std::string notes;
  const ml::Motion m = ml::read_motion(fault("bvh_one_row_more.bvh"), {}, &notes);
  CHECK(m.frames() == 5);
  CHECK_MESSAGE(
      notes.find("bvh_one_row_more.bvh: ignored: everything after the 5 frames, from '2.666667' on\n") != notes.npos,
      notes);
}

TEST_CASE("BVH: the table is read however many rows are declared and whatever follows it") {
  ml::Philox draw{.seed = 5};
  const auto& table = ml::skeleton_table("Mixamo");
  for (int i = 0; i < 60; ++i) {
    const RandomFile file = walk_among_others(table, draw);
    const auto has = static_cast<ml::Index>(file.rows.size());
    const ml::Bvh whole = ml::parse_bvh(file.text("4"));
    CHECK(whole.notes.empty());
    const auto declared = static_cast<ml::Index>(draw.uniform() * 8);  // 0 to 7
    const std::string rest = std::array{
        "", "\n\n", "# end", "}\n", "1 2 3\n", "END OF FILE", "\x1A", "0.5"}[static_cast<std::size_t>(i) % 8];
    const bool rubbish = rest.find_first_not_of("\n\x1A") != rest.npos;
    const ml::Bvh read = ml::parse_bvh(file.text(std::to_string(declared)) + rest);
    CAPTURE(declared);
    CAPTURE(rest);
    CHECK(read.frames == (declared == 0 ? has : std::min(declared, has)));
    CHECK(std::equal(read.values.begin(), read.values.end(), whole.values.begin()));
    CHECK(static_cast<ml::Index>(read.values.size()) == read.frames * read.channels());
    CHECK(read.notes.empty() == (declared == has && !rubbish));
    // cut somewhere in the last row: the whole rows before it
    std::string cut = file.text("4");
    const std::size_t last = cut.rfind('\n', cut.size() - 2);
    cut.resize(last + 2 + static_cast<std::size_t>(draw.uniform() * 0.8 * static_cast<double>(cut.size() - last)));
    const ml::Bvh shorter = ml::parse_bvh(cut);
    CHECK(shorter.frames == 3);
    REQUIRE(shorter.notes.size() == 1);
    CHECK(shorter.notes[0].starts_with("it has 3 whole frames, not the 4 declared frames of "));
  }
}

TEST_CASE("BVH: rows that do not fit the channels are refused, not read askew") {
  ml::Philox draw{.seed = 6};
  const RandomFile file = walk_among_others(ml::skeleton_table("Mixamo"), draw);
  for (const bool longer : {true, false}) {
    RandomFile other = file;
    for (auto& row : other.rows) longer ? row.push_back(1) : row.pop_back();
    CHECK_THROWS_AS(ml::parse_bvh(other.text("4")), ml::io_error);
    CHECK_THROWS_AS(ml::parse_bvh(other.text("3")), ml::io_error);
    CHECK_THROWS_AS(ml::parse_bvh(other.text("9")), ml::io_error);
  }
  CHECK_THROWS_WITH_AS(ml::parse_bvh(with(file.text("4"), "Frame Time: 0.05\n", "Frame Time: 0.05\nhello ")),
                       Contains("expected a value of the motion, found 'hello'"), ml::io_error);
  std::string none = file.text("4");
  none.resize(none.find("0.05\n") + 5);
  CHECK_THROWS_WITH_AS(ml::parse_bvh(none), Contains("the text is too short for the 4 declared frames"), ml::io_error);
}

TEST_CASE("BVH: UTF-16, with or without a mark, reads as UTF-8") {
  const ml::Motion m = ml::read_motion(fault("bvh_utf16.bvh"));
  const ml::Motion z = ml::read_motion(fault("bvh_one_row_more.bvh"));
  CHECK(m.skeleton.names == z.skeleton.names);
  CHECK(m.frames() > 0);
  const std::string text = ml::format_bvh(ml::to_bvh(synthetic::walk({.frames = 2})));
  for (const bool mark : {true, false}) {
    std::string wide = mark ? "\xFE\xFF" : "";
    for (const char c : text) wide += std::string(1, '\0') + c;
    CHECK(ml::parse_bvh(wide).values == ml::parse_bvh(text).values);
  }
}

TEST_CASE("BVH: decimal commas are read as points, and a note says so") {
  std::string notes;
  const ml::Motion m = ml::read_motion(fault("bvh_decimal_commas.bvh"), {}, &notes);
  CHECK_MESSAGE(notes.find("numbers have decimal commas: '0,000000' is read as with a point") != notes.npos, notes);
  std::string points = ml::read_file(fault("bvh_decimal_commas.bvh"));
  std::replace(points.begin(), points.end(), ',', '.');
  const ml::Motion other = ml::to_motion(ml::parse_bvh(points));
  CHECK(synthetic::largest_distance(m, other) == 0);
  CHECK(m.fps == other.fps);
  CHECK(m.skeleton.offset(1).y == Approx(0.1));
  ml::Philox draw{.seed = 7};
  const std::string text = walk_among_others(ml::skeleton_table("Noitom"), draw).text("4");
  std::string commas = text;
  std::replace(commas.begin(), commas.end(), '.', ',');
  CHECK(ml::parse_bvh(commas).values == ml::parse_bvh(text).values);
  for (const char* number : {"1,2,3", "1.234,5", "1,234.5", ",", "-,", "1,5x"}) {
    CAPTURE(number);
    CHECK_THROWS_WITH_AS(ml::parse_bvh(std::string("HIERARCHY ROOT r { OFFSET 0 ") + number + " 0 } MOTION"),
                         Contains("a number has one decimal point or comma, and nothing between thousands"),
                         ml::io_error);
  }
}

TEST_CASE("BVH: names in UTF-8 and with colons stay, through every format") {
  const ml::Motion m = ml::read_motion(fault("bvh_names_lost.bvh"));
  const TemporaryFolder folder;
  for (const char* name : {"センター", "左腕", "mixamorig:Spine"}) CHECK(m.skeleton.find(name) >= 0);
  for (const char* file : {"out.bvh", "out.glb"}) {
    ml::write_motion(folder / file, m);
    CHECK(ml::read_motion(folder / file).skeleton.names == m.skeleton.names);
  }
  CHECK(ml::bvh_names(m.skeleton) == m.skeleton.names);
}

TEST_CASE("BVH: random names come back as bvh_names says, and from GLB as they were") {
  ml::Philox draw{.seed = 9};
  const std::array<char32_t, 14> letters{'a', 'Z', '_',  '.',    ':',    '-',     '7',
                                         ' ', '{', 0xE9, 0x5DE6, 0x3000, 0x1F3C3, '|'};
  const TemporaryFolder folder;
  for (int i = 0; i < 100; ++i) {
    ml::Motion m = synthetic::walk({.frames = 1});
    for (std::string& name : m.skeleton.names) {
      name.clear();
      for (int n = static_cast<int>(draw.uniform() * 12); n >= 0; --n)
        ml::append_utf8(name, letters[static_cast<std::size_t>(draw.uniform() * letters.size())]);
      name += std::to_string(&name - m.skeleton.names.data());
    }
    const auto names = ml::bvh_names(m.skeleton);
    for (std::size_t j = 0; j < names.size(); ++j) {
      const bool fits = m.skeleton.names[j].find_first_of(" {") == std::string::npos;
      CHECK(fits == (names[j] == m.skeleton.names[j]));
    }
    const ml::Motion again = ml::to_motion(ml::parse_bvh(ml::format_bvh(ml::to_bvh(m))));
    for (const std::string& name : names) CHECK(again.skeleton.find(name) >= 0);
    ml::write_glb(folder / "out.glb", m);
    CHECK(ml::read_glb(folder / "out.glb").skeleton.names == m.skeleton.names);
  }
}

TEST_CASE("BVH: names in another encoding than UTF-8 are read as ISO 8859-1, and a note says so") {
  const ml::Bvh file = ml::parse_bvh(
      "HIERARCHY ROOT H\xFC"
      "fte { OFFSET 0 0 0 } MOTION Frames: 0 Frame Time: 1");
  CHECK(file.nodes[0].name == "Hüfte");
  REQUIRE(file.notes.size() == 1);
  CHECK(file.notes[0] == "1 name is not UTF-8, read as ISO 8859-1");
}

TEST_CASE("a Git LFS pointer and a page in place of a file are called that, whatever the kind") {
  const TemporaryFolder folder;
  const std::string pointer =
      "version https://git-lfs.github.com/spec/v1\n"
      "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";
  const std::string page = "\n<!DOCTYPE html>\n<html lang=\"en\"><head><title>404</title></head></html>\n";
  for (const char* file : {"a.bvh", "a.amc", "a.npz", "a.npy", "a.glb", "a.gltf", "a.vrm", "a.vrma"}) {
    ml::write_file(folder / "a.asf", ":bonedata\n");
    ml::write_file(folder / file, pointer);
    CHECK_THROWS_WITH_AS(ml::read_motions(folder / file),
                         Contains("is not the file but a Git LFS pointer to it (12345 bytes): 'git lfs pull'"),
                         ml::io_error);
    CHECK_THROWS_WITH_AS(ml::parse_motions(std::as_bytes(std::span(pointer)), folder / file),
                         Contains("Git LFS pointer"), ml::io_error);
    ml::write_file(folder / file, page);
    CHECK_THROWS_WITH_AS(ml::read_motions(folder / file), Contains("is not a motion but a page (HTML)"), ml::io_error);
  }
  ml::write_file(folder / "model.safetensors", pointer);
  CHECK_THROWS_WITH_AS(ml::read_file(folder / "model.safetensors"), Contains("[motionlang.io.401]"), ml::io_error);
}

TEST_CASE("another kind of content, or none, is reported") {
  const TemporaryFolder folder;
  const auto zip = std::string("PK\3\4") + std::string(30, 'x');
  const std::pair<std::string, const char*> contents[] = {
      {zip, " is a ZIP archive: unpack it first"},
      {"\x1F\x8B\b more", " is compressed by gzip: unpack it first"},
      {"7z\xBC\xAF' more", " is a 7z archive"},
      {"Rar!\x1A", " is a RAR archive"},
      {"Kaydara FBX Binary  ", " is an FBX file: Blender makes"},
      {"<?xml version='1.0'?><Error/>", " is not a motion but XML"},
      {std::string(100, '\0'), ": the file begins with zeros"},
      {"", ": the file is empty"},
  };
  for (const auto& [content, said] : contents) {
    CAPTURE(said);
    const auto bytes = std::as_bytes(std::span(content));
    for (const char* name : {"a.bvh", "a.glb", "a.vrma"})
      CHECK_THROWS_WITH_AS(ml::parse_motions(bytes, name), Contains((name + std::string(said)).c_str()), ml::io_error);
  }
  const std::string bvh = "HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 0 Frame Time: 1", glb = "glTF more";
  CHECK_THROWS_WITH_AS(ml::parse_motions(std::as_bytes(std::span(bvh)), "a.glb"), Contains("is a BVH file"),
                       ml::io_error);
  CHECK_THROWS_WITH_AS(ml::parse_motions(std::as_bytes(std::span(glb)), "a.bvh"), Contains("is a GLB file"),
                       ml::io_error);
  CHECK(ml::parse_motions(std::as_bytes(std::span(bvh)), "a.bvh").size() == 1);
}

TEST_CASE("BVH: gaps of a recording, which are not numbers, are filled from the frame before") {
  const std::string text =
      "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 Xposition Yposition Zposition } MOTION Frames: 4 Frame Time: 0.1\n";
  const ml::Bvh file = ml::parse_bvh(text + "1 nan 3\n-nan(ind) NaN 6\n7 8 1.#QNAN\nnan(snan) -1.#IND 9\n", "f.bvh");
  CHECK(file.values == std::vector<double>{1, 8, 3, 1, 8, 6, 7, 8, 6, 7, 8, 9});
  REQUIRE(file.notes.size() == 1);
  CHECK(file.notes[0] == "6 values are not a number: that of the frame before stands in");
  CHECK(ml::parse_bvh(text + "1 nan 1\n2 nan 1\n3 nan 1\n4 nan 1\n").values ==
        std::vector<double>{1, 0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1});
  const ml::Bvh cut = ml::parse_bvh(text + "1 2 3\n4 nan 6\n7 8 9\nnan nan");  // of which the last row is none
  CHECK(cut.frames == 3);
  CHECK(cut.values == std::vector<double>{1, 2, 3, 4, 2, 6, 7, 8, 9});
  CHECK_THROWS_WITH_AS(ml::parse_bvh(text + "1 2 nanometre\n"), Contains("expected a value of the motion"),
                       ml::io_error);
}

TEST_CASE("BVH: frame times of few decimals are those of a usual rate, and a rate in their place has a note") {
  const auto read = [](const std::string& time) {
    return ml::parse_bvh("HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition } MOTION Frames: 2 Frame Time: " + time +
                         "\n1\n2\n");
  };
  const std::pair<const char*, double> rates[] = {{"0.0333", 30},
                                                  {"0.033", 30},
                                                  {"0.0167", 60},
                                                  {"0.017", 60},
                                                  {"0.042", 24},
                                                  {"0.0417", 24},
                                                  {"0.00833", 120},
                                                  {"0,0333", 30},
                                                  {"0.0041", 1 / 0.0041},
                                                  {"0.034", 1 / 0.034},
                                                  {"0.041708", 1 / 0.041708}};
  for (const auto& [time, rate] : rates) {
    CAPTURE(time);
    const ml::Bvh file = read(time);
    CHECK(ml::to_motion(file).fps == Approx(rate).epsilon(1e-12));
    const bool note = rate == std::round(rate);
    CHECK(std::any_of(file.notes.begin(), file.notes.end(),
                      [](const std::string& n) { return n.find("is read as that of") != n.npos; }) == note);
  }
  for (const char* exact : {"0.008", "0.04", "0.025", "0.01", "0.0333333", "0.008333", "1e-2"}) {
    CAPTURE(exact);
    CHECK(read(exact).notes.empty());
    CHECK(read(exact).frame_time == std::stod(exact));
  }
  REQUIRE(read("30").notes.size() == 1);
  CHECK(read("30").notes[0] == "a frame takes 30 s, as if the rate stood where the frame time should");
}

TEST_CASE("a table of joints in a file says where the body begins, in BVH and in GLB") {
  const TemporaryFolder folder;
  ml::Skeleton body = rigs::skeleton_of(ml::skeleton_table("Mixamo"));
  std::string table;
  for (const auto& row : ml::skeleton_table("Mixamo").joints) {
    if (body.find(row.source) < 0) continue;
    body.names[static_cast<std::size_t>(body[row.source])] = "my" + row.source;
    table += row.target + "\tmy" + row.source + "\n";
  }
  body.names.push_back("prop"), body.parents.push_back(0), body.offsets.push_back({1, 0, 0});
  ml::Motion motion{body, 30, {}, {}, "m"};
  for (int f = 0; f < 5; ++f) {
    motion.root.push_back({0.1 * f, 0, 0});
    motion.local.resize(motion.local.size() + body.names.size(), ml::Quaternion<double>::identity());
    motion.local.back() = ml::normalized(ml::Quaternion<double>{1, 0, 0.1 * f, 0});
    motion.local[motion.local.size() - body.names.size()] = ml::normalized(ml::Quaternion<double>{1, 0, 0.05 * f, 0});
  }
  ml::write_file(folder / "table.txt", table);
  for (const char* file : {"m.bvh", "m.glb"}) {
    CAPTURE(file);
    ml::write_motion(folder / file, motion);
    CHECK(ml::read_motion(folder / file).skeleton.names.front() == "root_on_floor");
    CHECK_THROWS_WITH_AS(ml::on_smpl(ml::read_motion(folder / file)), Contains("no table fits"), ml::config_error);
    std::string notes;
    const ml::Motion read = ml::read_motion(folder / file, {.joints = (folder / "table.txt").string()}, &notes);
    CHECK(read.skeleton.names.front() == "pelvis");
    CHECK(notes.find("prop") != notes.npos);
    ml::JointTransforms<double> world;
    motion.world(4, world);
    const auto at = [&](const char* name) { return world.position[static_cast<std::size_t>(body[name])]; };
    const auto hips = 0.5 * (at("myLeftUpLeg") + at("myRightUpLeg"));
    const auto seen = read.positions();
    const auto& smpl = read.skeleton;
    const std::size_t row = 4 * smpl.names.size();
    check_equal(0.5 * (seen[row + static_cast<std::size_t>(smpl["left_hip"])] +
                       seen[row + static_cast<std::size_t>(smpl["right_hip"])]),
                hips);
  }
}

TEST_CASE("BVH: another axis up is found and turned, whatever axis it is") {
  const ml::Motion lying = ml::read_motion(fault("bvh_z_up.bvh"));
  const auto stands = ml::find_up_axis(lying);
  REQUIRE(stands);
  CHECK(stands->axis == ml::UpAxis::z);
  const ml::Motion upright = ml::read_motion(fault("bvh_z_up.bvh"), {.up = ml::UpAxis::z});
  CHECK(!ml::find_up_axis(upright));
  const auto p = lying.positions(), q = upright.positions();
  for (std::size_t i = 0; i < p.size(); ++i) check_equal(q[i], {p[i].x, p[i].z, -p[i].y}, 1e-9);
  const TemporaryFolder folder;
  ml::write_motion(folder / "out.npz", upright);
}
