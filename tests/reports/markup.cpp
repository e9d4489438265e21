// SPDX-License-Identifier: BSD-3-Clause
#include "tests/reports/markup.hpp"

#include <cctype>
#include <set>
#include <vector>

#include <fmt/format.h>

namespace impactrig::tests {

namespace {

class Checker {
 public:
  Checker(std::string_view text, bool html) : text_(text), html_(html) {}

  std::string problem() {
    if (html_ && text_.substr(0, 15) == "<!doctype html>") at_ = 15;
    while (at_ < text_.size() && problem_.empty()) {
      if (text_[at_] == '<')
        tag();
      else if (text_[at_] == '&')
        entity();
      else if (open_.empty() && !std::isspace(static_cast<unsigned char>(text_[at_])))
        fail("text outside the element");
      else
        ++at_;
    }
    if (problem_.empty() && !open_.empty()) fail("<" + open_.back() + "> is not closed");
    if (problem_.empty() && roots_ != 1) fail("there must be one element");
    return problem_;
  }

 private:
  void fail(const std::string& what) {
    problem_ = fmt::format("{} at {}: {}", what, at_, text_.substr(at_, 40));
  }

  static bool in_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == ':';
  }

  std::string name() {
    std::string out;
    while (at_ < text_.size() && in_name(text_[at_])) out += text_[at_++];
    return out;
  }

  void spaces() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  void entity() {
    const std::size_t end = text_.find(';', at_);
    if (end == std::string_view::npos || end - at_ > 8 || end == at_ + 1) return fail("bare &");
    for (std::size_t i = at_ + 1; i < end; ++i)
      if (!in_name(text_[i]) && text_[i] != '#') return fail("bare &");
    at_ = end + 1;
  }

  void close() {
    at_ += 2;
    const std::string closed = name();
    if (open_.empty() || open_.back() != closed) return fail("</" + closed + "> closes nothing");
    open_.pop_back();
    if (at_ >= text_.size() || text_[at_] != '>') return fail("expected >");
    ++at_;
  }

  void attribute(std::set<std::string>& seen) {
    const std::string key = name();
    if (key.empty()) return fail("expected an attribute");
    if (!seen.insert(key).second) return fail("attribute " + key + " twice");
    if (text_[at_] != '=') {
      if (!html_) fail("attribute " + key + " without a value");
      return;
    }
    ++at_;
    if (text_[at_] != '"') return fail("attribute " + key + " is not quoted");
    ++at_;
    while (at_ < text_.size() && text_[at_] != '"' && problem_.empty()) {
      if (text_[at_] == '<') return fail("< in an attribute");
      if (text_[at_] == '&')
        entity();
      else
        ++at_;
    }
    ++at_;
  }

  void tag() {
    if (text_.substr(at_, 2) == "</") return close();
    ++at_;
    const std::string opened = name();
    if (opened.empty()) return fail("bare <");
    if (open_.empty()) ++roots_;
    std::set<std::string> seen;
    for (spaces(); at_ < text_.size() && in_name(text_[at_]) && problem_.empty(); spaces())
      attribute(seen);
    if (!problem_.empty()) return;
    const bool empty = text_.substr(at_, 2) == "/>";
    at_ += empty ? 2 : 1;
    if (text_[at_ - 1] != '>') return fail("expected >");
    static const std::set<std::string> void_elements{"meta", "br", "link", "input", "wbr", "col"};
    if (empty || (html_ && void_elements.count(opened) != 0)) return;
    open_.push_back(opened);
    if (!html_ || (opened != "script" && opened != "style")) return;
    at_ = text_.find("</" + opened + ">", at_);
    if (at_ == std::string_view::npos) at_ = text_.size();
  }

  std::string_view text_;
  bool html_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
  int roots_ = 0;
  std::string problem_;
};

}  // namespace

std::string markup_problem(std::string_view xml) {
  return Checker(xml, false).problem();
}

std::string html_problem(std::string_view html) {
  return Checker(html, true).problem();
}

}  // namespace impactrig::tests
