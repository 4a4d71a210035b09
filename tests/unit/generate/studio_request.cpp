// Requests to the studio's server: who may ask, and what may be asked.
#include <motionlang/generate/studio_request.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

const std::string secret = "0123456789abcdef0123456789abcdef";
const ml::StudioGate gate{.hosts = ml::loopback_hosts(8421), .token = secret};

ml::StudioHead question() {
  return {.method = "POST",
          .path = "/ask",
          .host = "127.0.0.1:8421",
          .origin = "http://127.0.0.1:8421",
          .site = "same-origin",
          .type = "application/json",
          .token = secret};
}
ml::StudioHead page() { return {.method = "GET", .path = "/", .host = "localhost:8421"}; }

/// The status for a head of which one field is another.
int with(std::string ml::StudioHead::*field, const std::string& value, ml::StudioHead head = question()) {
  head.*field = value;
  return ml::refusal(gate, head).status;
}

ml::StudioQuestion parsed(const std::string& members, const ml::StudioLimits& limits = {}) {
  return ml::parse_studio_question(R"({"client":")" + secret + "\"," + members + "}", limits);
}

}  // namespace

TEST_CASE("the page and its questions pass") {
  CHECK(ml::refusal(gate, page()).status == 0);
  CHECK(with(&ml::StudioHead::method, "HEAD", page()) == 0);
  CHECK(with(&ml::StudioHead::host, "[::1]:8421", page()) == 0);
  CHECK(with(&ml::StudioHead::host, "LOCALHOST:8421", page()) == 0);
  CHECK(with(&ml::StudioHead::site, "none", page()) == 0);
  CHECK(ml::refusal(gate, question()).status == 0);
  CHECK(with(&ml::StudioHead::type, "Application/JSON; charset=utf-8") == 0);
  CHECK(with(&ml::StudioHead::origin, "") == 0);  // a program
}

TEST_CASE("a name that somebody else made lead here is refused, for the page as well") {
  for (const char* host : {"", "evil.example:8421", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8421.evil.example",
                           "localhost:84210", "127.0.0.1:8421 ", "0.0.0.0:8421"}) {
    CHECK_MESSAGE(with(&ml::StudioHead::host, host) == 421, host);
    CHECK_MESSAGE(with(&ml::StudioHead::host, host, page()) == 421, host);
  }
}

TEST_CASE("hosts are compared in small letters, and the port 80 may be left out") {
  const ml::StudioGate own{.hosts = {"My-Machine:80"}, .token = secret};
  const auto status = [&](const std::string& host, const std::string& origin) {
    auto head = question();
    head.host = host, head.origin = origin;
    return ml::refusal(own, head).status;
  };
  for (const char* host : {"my-machine", "my-machine:80", "My-Machine", "MY-MACHINE:80"}) {
    CHECK_MESSAGE(status(host, "") == 0, host);
    CHECK_MESSAGE(status(host, "http://my-machine") == 0, host);
    CHECK_MESSAGE(status(host, "http://my-machine:80") == 0, host);
    CHECK_MESSAGE(status(host, "https://my-machine") == 403, host);
    CHECK_MESSAGE(status(host, "http://my-machine:8") == 403, host);
  }
  for (const char* host : {"", ":80", "my-machine:", "my-machine:8", "my-machine:8080", "my-machine:80:80", "my"})
    CHECK_MESSAGE(status(host, "") == 421, host);
}

TEST_CASE("pages of other origins and sites are refused") {
  for (const char* origin : {"null", "http://evil.example", "https://127.0.0.1:8421", "http://127.0.0.1:8422",
                             "http://localhost:8421", "http://127.0.0.1:8421.evil.example"})
    CHECK_MESSAGE(with(&ml::StudioHead::origin, origin) == 403, origin);
  for (const char* site : {"cross-site", "same-site", "Same-Origin"})
    CHECK_MESSAGE(with(&ml::StudioHead::site, site) == 403, site);
}

TEST_CASE("the token, the path, the method and the type have to fit") {
  for (const std::string& token : {std::string(), secret.substr(1), secret + "0", "1" + secret.substr(1)})
    CHECK(with(&ml::StudioHead::token, token) == 401);
  auto open = gate;
  open.token = "";
  CHECK(ml::refusal(open, question()).status == 401);  // no token is none that fits
  for (const char* path : {"/ask/", "/../etc/passwd", "//ask", "", "/index.html", "/ask?x", "/%2e%2e/", "*"})
    CHECK_MESSAGE(with(&ml::StudioHead::path, path) == 404, path);
  for (const char* method : {"GET", "PUT", "OPTIONS", "DELETE", "HEAD", "post", ""})
    CHECK_MESSAGE(with(&ml::StudioHead::method, method) == 405, method);
  CHECK(with(&ml::StudioHead::method, "POST", page()) == 405);
  for (const char* type : {"", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=x"})
    CHECK_MESSAGE(with(&ml::StudioHead::type, type) == 415, type);
}

TEST_CASE("a question has its fields") {
  const auto q = parsed(R"("kind":"generate","timeline":"walk # 0 # 2","seed":18446744073709551615,"fast":true,
      "beyond":1.5,"record":3,"clip":{"id":"a","from":0.5,"start":1,"end":2.5,"parts":"legs"})");
  CHECK(q.kind == "generate");
  CHECK(q.client == secret);
  CHECK(q.timeline == "walk # 0 # 2");
  CHECK(q.seed == 18446744073709551615u);
  CHECK(q.fast);
  CHECK(q.beyond == 1.5);
  CHECK(q.record == 3);
  REQUIRE(q.clip);
  CHECK(q.clip->id == "a");
  CHECK(q.clip->parts == "legs");
  CHECK(q.clip->from == 0.5);
  CHECK(q.clip->start == 1);
  CHECK(q.clip->end == 2.5);
  CHECK(parsed(R"("kind":"search","words":"a person jumps","count":5)").words == "a person jumps");
  CHECK(parsed(R"("kind":"moment","motion":7)").motion == 7);
  const auto plain = parsed(R"("kind":"save","format":".glb","motion":2,"record":null,"clip":null,"character":null)");
  CHECK(plain.motion == 2);
  CHECK(plain.format == ".glb");
  CHECK_FALSE(plain.record);
  CHECK_FALSE(plain.clip);
  CHECK_FALSE(plain.has_character);
  CHECK_FALSE(plain.over);
  CHECK(parsed(R"("kind":"store","name":"x.json","over":"")").over == "");
  CHECK(parsed(R"("kind":"store","name":"x.json","over":"0123")").over == "0123");
  const auto file = parsed(R"("kind":"save","motion":1,"character":{"name":"me.vrm","bytes":"AAEC"})");
  CHECK(file.has_character);
  CHECK(file.name == "me.vrm");
  CHECK(file.bytes == std::vector<std::byte>{std::byte{0}, std::byte{1}, std::byte{2}});
}

TEST_CASE("anything else is an error") {
  for (const char* text : {"", "{", "[]", "null", "7", "{\"kind\":\"load\"}", "{\"kind\":\"load\",\"client\":\"x\"}"})
    CHECK_THROWS_AS(ml::parse_studio_question(text), ml::error);
  CHECK_THROWS_AS(ml::parse_studio_question(std::string(100000, '[')), ml::error);
  for (const char* members : {R"("kind":"run")",
                              R"("kind":1)",
                              R"("kind":"load","kind":"load")",
                              R"("kind":"check","timeline":3)",
                              R"("kind":"generate","seed":-1)",
                              R"("kind":"generate","seed":1e30)",
                              R"("kind":"generate","beyond":-1)",
                              R"("kind":"generate","beyond":1e300)",
                              R"("kind":"known","count":51)",
                              R"("kind":"known","count":-1)",
                              R"("kind":"search","words":["a"])",
                              R"("kind":"search","words":"a","count":51)",
                              R"("kind":"moment","motion":-1)",
                              R"("kind":"save","motion":1.5)",
                              R"("kind":"generate","record":-1)",
                              R"("kind":"store","over":1)",
                              R"("kind":"generate","clip":[])",
                              R"("kind":"generate","clip":{"start":2,"end":1})",
                              R"("kind":"generate","clip":{"start":200})",
                              R"("kind":"read","bytes":"%%%")",
                              R"("kind":"read","name":"../x.bvh")",
                              R"("kind":"read","name":"x.amc")",
                              R"("kind":"save","character":{"name":"a/b.vrm"})",
                              R"("kind":"save","character":3)"})
    CHECK_THROWS_AS(parsed(members), ml::error);
}

TEST_CASE("texts and files have limits") {
  const ml::StudioLimits small{.question = 200, .file = 30, .text = 40};
  CHECK_NOTHROW(parsed(R"("kind":"check","timeline":"walk # 0 # 2")", small));
  CHECK_THROWS_AS(parsed(R"("kind":"check","timeline":"walk very, very, very, very, very far # 0 # 2")", small),
                  ml::config_error);
  CHECK_NOTHROW(parsed(R"("kind":"read","bytes":")" + std::string(40, 'A') + "\"", small));
  CHECK_THROWS_AS(parsed(R"("kind":"read","bytes":")" + std::string(48, 'A') + "\"", small), ml::config_error);
  CHECK_THROWS_AS(parsed(R"("kind":"load","x":")" + std::string(200, 'A') + "\"", small), ml::config_error);
}

TEST_CASE("names of files are plain") {
  for (const char* name :
       {"walk.bvh", "a_b-c 2.glb", "x.tar.npz", "A.txt", "me.gltf", "_.bvh", "cone.bvh", "com10.bvh", "com.bvh",
        "my con.bvh", "x.nul.bvh", "my_project.json", "walk.png", "walk.gif", "walk.webm", "w.mp4"})
    CHECK_MESSAGE(ml::is_studio_file(name), name);
  for (const char* name : {"",         ".",           "..",          ".bvh",    "walk",     "walk.exe",
                           "walk.BVH", "../walk.bvh", "/walk.bvh",   "a/b.bvh", "a\\b.bvh", ".motionlang.index",
                           "a.index",  "C:a.bvh",     " a.bvh",      "a .bvh",  "a..bvh",   "a.bvh ",
                           "a.bvh.",   "-\n.bvh",     "\xc3\xa4.bvh"})
    CHECK_MESSAGE(!ml::is_studio_file(name), name);
  for (const char* name : {"con.bvh", "CON.txt", "prn.glb", "aux.npz", "Nul.tar.npy", "com0.bvh", "COM1.bvh",
                           "lpt9.svg", "lpt0.bvh", "con .x.bvh"})
    CHECK_MESSAGE(!ml::is_studio_file(name), name);
  CHECK_FALSE(ml::is_studio_file(std::string("a\0.bvh", 6)));
  CHECK_FALSE(ml::is_studio_file(std::string(97, 'a') + ".bvh"));
  CHECK(ml::is_studio_file(std::string(96, 'a') + ".bvh"));
}
