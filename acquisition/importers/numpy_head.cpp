// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/numpy_head.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "acquisition/importers/text_encoding.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::uint64_t longest_head = std::uint64_t{1} << 20;  ///< [bytes]
constexpr std::size_t most_fields = 1000;
constexpr int deepest = 16;  ///< lists in lists

/// What Python writes of a value.
struct Literal {
  enum class Kind { text, number, word, list };

  Kind kind = Kind::word;
  std::string text;  ///< of a text or a word, as True
  std::uint64_t number = 0;
  std::vector<Literal> items;  ///< of a dictionary: keys and values by turns
};

/// Reads the literals of a head: texts, whole numbers, True, lists, tuples, dictionaries. Throws
/// a sentence about what stands where it should not.
class LiteralReader {
 public:
  explicit LiteralReader(std::string_view text) : text_(text) {}

  Literal read(int depth = 0) {
    const char first = next();
    if (depth > deepest) throw std::string("lists nested too deeply");
    if (first == '\'' || first == '"') return quoted(first);
    if (is_prefixed()) ++at_;
    if (text_[at_] == '\'' || text_[at_] == '"') return quoted(text_[at_]);
    if (first == '(' || first == '[' || first == '{') return list(first, depth);
    return word();
  }

 private:
  char next() {
    while (at_ < text_.size() && std::string_view(" \n\t\r").find(text_[at_]) != text_.npos) ++at_;
    if (at_ == text_.size()) throw std::string("it ends early");
    return text_[at_];
  }

  /// Whether a text of Python 2 or bytes stand here: u'force'.
  bool is_prefixed() const {
    const bool quote = at_ + 1 < text_.size() && (text_[at_ + 1] == '\'' || text_[at_ + 1] == '"');
    return quote && (text_[at_] == 'u' || text_[at_] == 'b');
  }

  Literal quoted(char quote) {
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == text_.npos) throw std::string("a text has no end");
    Literal literal{Literal::Kind::text, std::string(text_.substr(at_ + 1, end - at_ - 1)), 0, {}};
    at_ = end + 1;
    return literal;
  }

  Literal list(char open, int depth) {
    const char close = open == '(' ? ')' : open == '[' ? ']' : '}';
    Literal literal{Literal::Kind::list, {}, 0, {}};
    for (++at_; next() != close;) {
      literal.items.push_back(read(depth + 1));
      if (const char behind = next(); behind == ',' || behind == ':') ++at_;
    }
    ++at_;
    return literal;
  }

  Literal word() {
    const std::size_t end = std::min(text_.find_first_of(" ,:)]}\n", at_), text_.size());
    Literal literal{Literal::Kind::word, std::string(text_.substr(at_, end - at_)), 0, {}};
    if (literal.text.empty())
      throw fmt::format("'{}' is not expected", to_utf8(text_.substr(at_, 1)));
    at_ = end;
    const char* const last = literal.text.data() + literal.text.size();
    const auto [behind, error] = std::from_chars(literal.text.data(), last, literal.number);
    // Python 2 writes 500L
    if (error == std::errc{} && (behind == last || std::string_view(behind, last) == "L"))
      literal.kind = Literal::Kind::number;
    return literal;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

const Literal& value_of(const Literal& dictionary, std::string_view key) {
  for (std::size_t i = 0; i + 1 < dictionary.items.size(); i += 2)
    if (dictionary.items[i].text == key) return dictionary.items[i + 1];
  throw fmt::format("it does not state '{}'", key);
}

/// "<f8": byte order, kind, size; a unit of times may follow.
NumpyField type_of(const std::string& text) {
  NumpyField field;
  std::string_view rest = text;
  if (!rest.empty() && std::string_view("<>=|").find(rest.front()) != std::string_view::npos) {
    field.big_endian = rest.front() == '>';
    rest.remove_prefix(1);
  }
  if (rest.empty()) throw fmt::format("the type '{}' is not known", to_utf8(text));
  field.kind = rest.front();
  const auto [behind, error] =
      std::from_chars(rest.data() + 1, rest.data() + rest.size(), field.size);
  if (error != std::errc{} && field.kind != 'O')
    throw fmt::format("the type '{}' is not known", to_utf8(text));
  if (field.kind == 'U') field.size *= 4;
  if (field.kind == 'O') field.size = 8;
  if (field.size > longest_head) throw fmt::format("elements of {} bytes", field.size);
  return field;
}

/// Lists the fields of a type: a text, or a list of (name, type) and (name, type, shape).
class FieldList {
 public:
  std::vector<NumpyField> take(const Literal& type, std::uint64_t& size) {
    size = add(type, "", 0);
    return std::move(fields_);
  }

 private:
  /// Gives the size.
  std::uint64_t add(const Literal& type, const std::string& name, std::uint64_t offset) {
    if (fields_.size() >= most_fields) throw fmt::format("more than {} fields", most_fields);
    if (type.kind == Literal::Kind::text) {
      fields_.push_back(type_of(type.text));
      fields_.back().name = name;
      fields_.back().offset = offset;
      return fields_.back().size;
    }
    if (type.kind != Literal::Kind::list) throw std::string("its 'descr' is no type");
    std::uint64_t size = 0;
    for (const Literal& field : type.items) size += add_field(field, name, offset + size);
    return size;
  }

  std::uint64_t add_field(const Literal& field, const std::string& within, std::uint64_t offset) {
    if (field.kind != Literal::Kind::list || field.items.size() < 2)
      throw std::string("a field has no name and type");
    // of a pair of title and name
    const Literal& first = field.items[0];
    const std::string own = to_utf8(first.items.empty() ? first.text : first.items.back().text);
    const std::string name = within.empty() ? own : within + "." + own;
    std::uint64_t elements = 1;
    if (field.items.size() > 2) {
      const Literal& shape = field.items[2];
      if (shape.kind == Literal::Kind::number) elements = shape.number;
      for (const Literal& side : shape.items)
        elements = side.number > most_fields ? most_fields + 1 : elements * side.number;
      if (elements > most_fields) throw fmt::format("more than {} fields", most_fields);
    }
    std::uint64_t size = 0;
    for (std::uint64_t i = 0; i < elements; ++i)
      size += add(field.items[1], elements == 1 ? name : fmt::format("{}:{}", name, i + 1),
                  offset + size);
    return size;
  }

  std::vector<NumpyField> fields_;
};

}  // namespace

NumpyHead read_numpy_head(ByteCursor& at, const std::string& what) {
  constexpr std::string_view magic = "\x93NUMPY";
  const datasets::SourcePosition place = at.position();
  const auto refuse = [&](const std::string& why) {
    throw datasets::InputError(place, fmt::format("the head of {}: {}", what, why));
  };
  at.set_big_endian(false);
  if (at.bytes(magic.size(), what) != magic) refuse("it is no NumPy array");
  const auto version = at.read<std::uint8_t>("the version of a NumPy array");
  at.read<std::uint8_t>("the version of a NumPy array");
  if (version < 1 || version > 3)
    refuse(fmt::format("it is of version {}, expected 1 to 3", version));
  const std::uint64_t length =
      version == 1 ? std::uint64_t{at.read<std::uint16_t>("the length of the head")}
                   : std::uint64_t{at.read<std::uint32_t>("the length of the head")};
  if (length > longest_head) refuse(fmt::format("it has {} bytes", length));
  const std::string_view text = at.bytes(length, "the head of a NumPy array");
  NumpyHead head;
  head.data = at.at();
  try {
    const Literal says = LiteralReader(text).read();
    head.fields = FieldList().take(value_of(says, "descr"), head.element_size);
    head.by_columns = value_of(says, "fortran_order").text == "True";
    for (const Literal& side : value_of(says, "shape").items) head.shape.push_back(side.number);
  } catch (const std::string& why) {
    refuse(why);
  }
  if (head.element_size == 0) refuse("its elements have no bytes");
  return head;
}

}  // namespace impactrig::acquisition
