// Pages that a test writes into a folder, looked at in one headless Chromium; skipped without it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/temporary_folder.h"
#include "support/browser.h"

namespace mocaplm {

// Why a test that needs one is skipped.
constexpr const char* kNoBrowser =
    "no Chromium: apt-get install chromium, or MOCAPLM_CHROMIUM=/path/to/it";

// Of the page that is open: script errors, messages of the console, and whatever was asked of
// anyone but the file itself.
inline std::vector<std::string> complaints(Browser& browser) {
  const std::string page = browser.evaluate("location.href.split('#')[0]");
  std::vector<std::string> found;
  for (const Json& event : browser.events) {
    const std::string method = event["method"], text = event.dump();
    // Chromium's own remark on how headless pictures are read back.
    const bool of_driver = text.find("GL Driver Message (OpenGL, Performance") != std::string::npos;
    if (method == "Runtime.exceptionThrown" || method == "Runtime.consoleAPICalled" ||
        (method == "Log.entryAdded" && !of_driver))
      found.push_back(text);
    if (method != "Network.requestWillBeSent") continue;
    const std::string asked = event["params"]["request"]["url"];
    if (asked.rfind("data:", 0) != 0 && asked.rfind(page, 0) != 0) found.push_back(asked);
  }
  return found;
}

// What is wrong with the letters of the pictures as they are shown now: texts that cover one
// another (leaning ones aside) or that leave their picture.
inline Json crowded_texts(Browser& browser) {
  return browser.evaluate(R"js([...document.querySelectorAll('svg[viewBox]')].flatMap((svg) => {
    const frame = svg.getBoundingClientRect();
    const texts = [...svg.querySelectorAll('text')].map((t) => [t, t.getBoundingClientRect()]);
    const level = texts.filter(([t]) => !t.hasAttribute('transform'));
    const out = texts.filter(([, r]) => r.left < frame.left - 1 || r.right > frame.right + 1 ||
        r.top < frame.top - 1 || r.bottom > frame.bottom + 1);
    const over = ([, a], [, b]) => a.left < b.right - 1 && b.left < a.right - 1 &&
        a.top < b.bottom - 2 && b.top < a.bottom - 2;
    const met = level.flatMap((a, i) => level.slice(i + 1).filter((b) => over(a, b))
        .map((b) => a[0].textContent + ' | ' + b[0].textContent));
    return out.map(([t]) => t.textContent + ' leaves the picture').concat(met);
  }))js");
}

class PagesInBrowser : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string program = find_browser();
    if (program.empty()) return;
    folder_ = std::make_unique<TemporaryFolder>();
    browser_ = std::make_unique<Browser>(program);
  }
  static void TearDownTestSuite() {
    browser_.reset();
    folder_.reset();
  }
  void SetUp() override {
    if (!browser_) GTEST_SKIP() << kNoBrowser;
    browser_->window(420, 480);  // small: without a graphics card each pixel costs
    browser_->media("prefers-color-scheme", "light");
  }

  static std::string url(const std::string& hash = "", const std::string& page = "page.html") {
    return "file://" + (*folder_ / page).string() + hash;
  }
  static std::vector<std::string> complaints() { return mocaplm::complaints(*browser_); }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static std::unique_ptr<Browser> browser_;
};

}  // namespace mocaplm
