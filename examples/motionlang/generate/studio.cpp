// motionlang studio: the page in which motion is made, served with any model. The questions are answered by
// generate/studio_server.hpp; this connects it to cpp-httplib, if that is installed.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <random>
#include <thread>

#include <motionlang/generate/studio_server.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../search/search_encoder.hpp"
#include "generation.hpp"

#ifdef MOTIONLANG_HTTP
#include "studio_connection.hpp"
#endif

namespace program {

namespace {

struct StudioCommand {
  std::string model = default_model().string(), backend = "eigen", project, host;
  std::string search_model = default_search_model().string();
  int port = 8421;
  ml::ModelSources sources;
  MachineOptions machine;
};

#ifdef MOTIONLANG_HTTP

/// Returns 32 random hexadecimal digits.
std::string secret() {
  std::random_device device;
  std::string out;
  for (int i = 0; i < 4; ++i) out += formatted("%08x", device());
  return out;
}

/// A folder of this process alone, which goes with it.
class Scratch {
 public:
  Scratch() : folder_(std::filesystem::temp_directory_path() / ("motionlang-studio-" + secret())) {
    if (!std::filesystem::create_directory(folder_)) ml::raise<ml::io_error>(401, folder_.string(), " exists already");
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
  }
  ~Scratch() {
    std::error_code failed;
    std::filesystem::remove_all(folder_, failed);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Returns a field that is given once; "" if it is missing, and "twice", which fits nothing, if there are several.
std::string field(const httplib::Request& request, const char* name) {
  return request.get_header_value_count(name) > 1 ? "twice" : request.get_header_value(name);
}
ml::StudioHead head_of(const httplib::Request& r) {
  return {.method = r.method,
          .path = r.path,
          .host = field(r, "Host"),
          .origin = field(r, "Origin"),
          .site = field(r, "Sec-Fetch-Site"),
          .type = field(r, "Content-Type"),
          .token = field(r, "X-Motionlang-Token")};
}

/// Reads a body that is neither too long nor too slow. False otherwise.
bool read_body(const httplib::ContentReader& reader, std::size_t most, std::string& body) {
  return reader([&](const char* data, std::size_t size) {
    if (size > most - body.size()) return false;
    body.append(data, size);
    return true;
  });
}

void connect(httplib::Server& http, ml::StudioServer& studio, const ml::StudioGate& gate) {
  http.new_task_queue = [] { return new httplib::ThreadPool(160); };  // so that many idle ones keep nobody waiting
  http.set_keep_alive_max_count(1);  // a body that was not read is never taken for the next request
  http.set_payload_max_length(studio.limits().question);
  http.set_default_headers({{"Cache-Control", "no-store"},
                            {"Content-Security-Policy", "frame-ancestors 'none'"},
                            {"Cross-Origin-Resource-Policy", "same-origin"},
                            {"Referrer-Policy", "no-referrer"},
                            {"X-Content-Type-Options", "nosniff"},
                            {"X-Frame-Options", "DENY"}});
  http.set_pre_routing_handler([&gate](const httplib::Request& request, httplib::Response& response) {
    const ml::StudioRefusal no = ml::refusal(gate, head_of(request));
    if (no.status == 0) return httplib::Server::HandlerResponse::Unhandled;
    response.status = no.status;
    response.set_content(no.reason, "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  http.Get("/", [&studio](const httplib::Request&, httplib::Response& response) {
    response.set_content(studio.page(), "text/html; charset=utf-8");
  });
  http.Post("/ask", [&studio](const httplib::Request&, httplib::Response& response,
                              const httplib::ContentReader& reader) {
    auto body = std::make_shared<std::string>();
    if (!read_body(reader, studio.limits().question, *body)) {
      response.status = 413;
      response.set_content("the question is too long or too slow\n", "text/plain");
      return;
    }
    response.set_chunked_content_provider("application/x-ndjson", [&studio, body](std::size_t, httplib::DataSink& to) {
      bool listens = true;
      studio.answer(*body, [&](std::string_view line) {
        return listens = listens && !interrupted && to.is_writable() && to.write(line.data(), line.size());
      });
      if (listens) to.done();
      return listens;
    });
  });
}

void serve(const StudioCommand& o, std::shared_ptr<const ml::MotionModel> model) {
  const Scratch scratch;
  ml::StudioServer studio(std::move(model), {.project = o.project, .scratch = scratch.path(), .search_model = [&o] {
                                               return search_encoder(o.search_model);
                                             }});
  TimedServer<httplib::Server> http(studio.limits());
  const char* const address = o.host.empty() ? "127.0.0.1" : "0.0.0.0";
  int port = o.port;
  if (port == 0)
    port = http.bind_to_any_port(address);
  else if (!http.bind_to_port(address, port))
    port = -1;
  if (port < 0) ml::raise<ml::io_error>(401, "port ", o.port, " of ", address, " is not free");
  ml::StudioGate gate{.hosts = ml::loopback_hosts(port), .token = secret()};
  if (!o.host.empty()) gate.hosts.push_back(formatted("%s:%d", o.host.c_str(), port));
  connect(http, studio, gate);
  std::printf("Open http://%s:%d/#token=%s\nCtrl-C ends the studio.\n", o.host.empty() ? "127.0.0.1" : o.host.c_str(),
              port, gate.token.c_str());
  std::fflush(stdout);
  std::atomic<bool> over = false;
  std::thread watch([&] {
    const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(50)); };
    while (!over && !(interrupted && http.is_running())) pause();
    if (!over) http.stop();
  });
  const bool ended = http.listen_after_bind();
  over = true;
  watch.join();
  if (!ended) ml::raise<ml::io_error>(401, "port ", port, " of ", address, " failed");
}

#else

void serve(const StudioCommand&, const std::shared_ptr<const ml::MotionModel>&) {
  ml::raise<usage_error>(102,
                         "this motionlang was built without cpp-httplib (Debian: libcpp-httplib-dev). The target "
                         "`studio` writes a page that needs no server");
}

#endif

void run(const StudioCommand& o) {
  o.machine.apply();
  serve(o, load_generator(o.backend, o.model, o.sources));
}

}  // namespace

void add_studio(CLI::App& app) {
  const auto o = std::make_shared<StudioCommand>();
  CLI::App* c = app.add_subcommand("studio",
                                   "Serves the studio to a browser on this machine: a page in which motion is made "
                                   "from texts on a timeline. Prints its link, which has a secret");
  c->add_option("--model", o->model,
                "Weights, as `generate` takes them. The default is the bundled model, or what MOTIONLANG_MODEL names");
  path_option(*c, "--text-encoder", o->sources.text_encoder,
              "Text encoder of a published model that contains none, as `generate` takes it");
  checked_option(*c, "--port", o->port, in_range(0, 65535), "Port of 127.0.0.1. 0 takes one that is free");
  path_option(*c, "--project", o->project,
              "Folder whose motions and timelines the page reads and writes. Without it, the browser saves files");
  folder_option(*c, "--search-model", o->search_model,
                "Folder of a TMR, by which words find moments in the motions of the project. The default is the "
                "bundled one");
  checked_option(*c, "--host", o->host, not_empty(),
                 "Name or address by which other machines reach this one. Then it listens to all of them, without "
                 "encryption: whoever has the link, or reads what is sent, can use the model and the project");
  checked_option(*c, "--backend", o->backend, CLI::IsMember({"eigen", "xtensor", "reference"}),
                 "Backend for the computation");
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
