// A headless Chromium that a test drives by the DevTools protocol over a pair of pipes: no library,
// no port, no network.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/find_program.h"
#include "common/json.h"
#include "common/temporary_folder.h"

namespace mocaplm {

// $MOCAPLM_CHROMIUM or the first of the usual names that is on the PATH; empty when there is none.
inline std::string find_browser() {
  if (const char* given = std::getenv("MOCAPLM_CHROMIUM")) return given;
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (const std::string file = find_program(name); !file.empty()) return file;
  return "";
}

class Browser {
 public:
  // Throws std::runtime_error when it does not answer, as all calls do after `seconds`.
  explicit Browser(const std::string& program, double seconds = 60) : seconds_(seconds) {
    start(program);
    const Json target = call("Target.createTarget", {{"url", "about:blank"}});
    session_ = call("Target.attachToTarget",
                    {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
    for (const char* domain : {"Page", "Runtime", "Log", "Network", "Accessibility"})
      call(domain + std::string(".enable"));
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;
  ~Browser() {
    ::close(to_);
    ::close(from_);
    ::kill(-child_, SIGTERM);
    for (int i = 0; i < 50 && ::waitpid(child_, nullptr, WNOHANG) == 0; ++i) pause(0.1);
    ::kill(-child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }

  // One command; events that arrive meanwhile are kept.
  Json call(const std::string& method, const Json& params = Json::object()) {
    Json message = {{"id", ++last_}, {"method", method}, {"params", params}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t wrote = ::write(to_, text.data() + at, text.size() - at);
      if (wrote <= 0) throw std::runtime_error(method + ": the browser has gone");
      at += static_cast<std::size_t>(wrote);
    }
    while (true) {
      const Json answer = receive(method);
      if (!answer.contains("id")) {
        events.push_back(answer);
      } else if (answer["id"] == last_) {
        if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.dump());
        return answer["result"];
      }
    }
  }

  // Opens a page afresh and waits until its scripts have run; `events` are from then on.
  void open(const std::string& url) {
    call("Page.navigate", {{"url", "about:blank"}});
    evaluate("1");
    events.clear();
    call("Page.navigate", {{"url", url}});
    while (evaluate("document.readyState") != "complete" || evaluate("location.href") != url)
      pause(0.05);
  }

  // The value of an expression, of a promise what it resolves to.
  Json evaluate(const std::string& expression) {
    const Json result =
        call("Runtime.evaluate",
             {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (result.contains("exceptionDetails"))
      throw std::runtime_error(expression + ": " + result["exceptionDetails"].dump());
    return result["result"].contains("value") ? result["result"]["value"] : Json();
  }

  // As a person presses it; `text` where the key writes something.
  void key(const std::string& key, const std::string& text = "", int modifiers = 0) {
    Json event = {{"type", "keyDown"}, {"key", key}, {"modifiers", modifiers}};
    if (!text.empty()) event["text"] = text;
    // Chromium closes dialogs by the number.
    if (key == "Escape") event["windowsVirtualKeyCode"] = 27;
    call("Input.dispatchKeyEvent", event);
    event["type"] = "keyUp";
    event.erase("text");
    call("Input.dispatchKeyEvent", event);
  }

  // The left button, at pixels of the window.
  void click(double x, double y) {
    for (const char* type : {"mouseMoved", "mousePressed", "mouseReleased"})
      call("Input.dispatchMouseEvent",
           {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}});
  }

  void window(int width, int height, bool phone = false) {
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", phone}});
  }

  // What the style sheet is told: {"prefers-color-scheme", "dark"} and the like.
  void media(const std::string& feature, const std::string& value) {
    call("Emulation.setEmulatedMedia",
         {{"features", Json::array({{{"name", feature}, {"value", value}}})}});
  }

  static void pause(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }

  std::vector<Json> events;

 private:
  void start(const std::string& program) {
    int in[2], out[2];
    if (::pipe2(in, O_CLOEXEC) != 0 || ::pipe2(out, O_CLOEXEC) != 0)
      throw std::runtime_error("no pipes");
    // Prepared here: between fork and exec nothing may allocate.
    const std::vector<std::string> words = {program,
                                            "--headless",
                                            "--no-sandbox",
                                            "--disable-gpu",
                                            "--use-angle=swiftshader",
                                            "--enable-unsafe-swiftshader",
                                            "--disable-dev-shm-usage",
                                            "--disable-quic",
                                            "--disable-sync",
                                            "--disable-component-update",
                                            "--disable-background-networking",
                                            "--no-first-run",
                                            "--remote-debugging-pipe",
                                            "--user-data-dir=" + profile_.path().string(),
                                            "about:blank"};
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    child_ = ::fork();
    if (child_ == 0) {
      ::setpgid(0, 0);
      // The pipes' own numbers may be 3 or 4: away with them first.
      const int reads = ::fcntl(in[0], F_DUPFD, 10), writes = ::fcntl(out[1], F_DUPFD, 10);
      const int quiet = ::open("/dev/null", O_RDWR);
      ::dup2(quiet, 1);
      ::dup2(quiet, 2);
      ::dup2(reads, 3);
      ::dup2(writes, 4);
      ::execv(program.c_str(), arguments.data());
      ::_exit(127);
    }
    ::setpgid(child_, child_);
    ::close(in[0]);
    ::close(out[1]);
    to_ = in[1];
    from_ = out[0];
  }

  Json receive(const std::string& method) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_);
    while (true) {
      const std::size_t zero = read_.find('\0', looked_);
      if (zero != std::string::npos) {
        const Json message = Json::parse(read_.substr(0, zero));
        read_.erase(0, zero + 1);
        looked_ = 0;
        return message;
      }
      looked_ = read_.size();
      pollfd wait{from_, POLLIN, 0};
      if (::poll(&wait, 1, 1000) > 0) {
        char buffer[65536];
        const ssize_t count = ::read(from_, buffer, sizeof buffer);
        if (count <= 0) throw std::runtime_error(method + ": the browser has gone");
        read_.append(buffer, static_cast<std::size_t>(count));
      } else if (std::chrono::steady_clock::now() > end) {
        throw std::runtime_error(method + ": the browser does not answer");
      }
    }
  }

  double seconds_;
  TemporaryFolder profile_;
  std::string session_, read_;
  std::size_t looked_ = 0;
  int child_ = -1, to_ = -1, from_ = -1;
  std::int64_t last_ = 0;
};

}  // namespace mocaplm
