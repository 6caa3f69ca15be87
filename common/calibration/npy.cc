#include "common/calibration/npy.h"

#include <bit>
#include <charconv>
#include <cstdint>

#include "common/base/little_endian.h"
#include "common/calibration/token_reader.h"

namespace depthfarm {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kShortPrefix = 10;  // magic, version, 16 bits of length
constexpr std::size_t kLongPrefix = 12;   // the same with 32 bits

struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

// Reads {'descr': '<f8', 'fortran_order': False, 'shape': (20, 17), } with any spaces and order of keys.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : text_(text) {}

  bool Read(Header& header) {
    bool descr = false;
    bool order = false;
    bool shape = false;
    if (!Take('{')) return false;
    while (!Take('}')) {
      std::string key;
      if (!String(key) || !Take(':')) return false;
      if (key == "descr" && !descr) {
        descr = String(header.descr);
        if (!descr) return false;
      } else if (key == "fortran_order" && !order) {
        order = Boolean(header.fortran_order);
        if (!order) return false;
      } else if (key == "shape" && !shape) {
        shape = Shape(header.shape);
        if (!shape) return false;
      } else {
        return false;
      }
      if (!Take(',') && !Peek('}')) return false;
    }
    SkipSpaces();
    return text_.empty() && descr && order && shape;
  }

 private:
  void SkipSpaces() {
    while (!text_.empty() && (text_.front() == ' ' || text_.front() == '\n')) text_.remove_prefix(1);
  }
  bool Peek(char c) {
    SkipSpaces();
    return text_.starts_with(c);
  }
  bool Take(char c) {
    if (!Peek(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool String(std::string& value) {
    if (!Take('\'')) return false;
    const std::size_t end = text_.find('\'');
    if (end == std::string_view::npos) return false;
    value = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    return true;
  }
  bool Boolean(bool& value) {
    SkipSpaces();
    for (const bool candidate : {false, true}) {
      const std::string_view word = candidate ? "True" : "False";
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      value = candidate;
      return true;
    }
    return false;
  }
  bool Shape(std::vector<std::uint64_t>& shape) {
    if (!Take('(')) return false;
    while (!Take(')')) {
      SkipSpaces();
      std::uint64_t side = 0;
      const auto [rest, error] = std::from_chars(text_.data(), text_.data() + text_.size(), side);
      if (error != std::errc()) return false;
      text_.remove_prefix(static_cast<std::size_t>(rest - text_.data()));
      shape.push_back(side);
      if (!Take(',') && !Peek(')')) return false;
    }
    return true;
  }

  std::string_view text_;
};

std::string ShapeText(const std::vector<std::uint64_t>& shape) {
  std::string text;
  for (const std::uint64_t side : shape) text += (text.empty() ? "" : ", ") + std::to_string(side);
  return "(" + text + ")";
}

}  // namespace

Result<NumberTable> ParseNpy(std::string_view bytes, const std::string& file) {
  const auto bad = [&](const std::string& what) { return InvalidArgument(file + ": " + what); };
  if (!bytes.starts_with(kMagic) || bytes.size() < kLongPrefix) return bad("is no NumPy file (.npy)");
  const unsigned version = static_cast<unsigned char>(bytes[kMagic.size()]);
  if (version < 1 || version > 3)
    return bad("has version " + std::to_string(version) + " of NumPy's format, expected 1 to 3");
  const std::size_t prefix = version == 1 ? kShortPrefix : kLongPrefix;
  const std::uint32_t length =
      version == 1 ? ReadU32(bytes, kShortPrefix - 2) & 0xFFFFU : ReadU32(bytes, kShortPrefix - 2);
  if (length > bytes.size() - prefix) return bad("ends within its header");
  const std::string_view text = bytes.substr(prefix, length);
  Header header;
  if (!HeaderReader(text).Read(header))
    return bad("has the header " + Quoted(text) + ", expected descr, fortran_order, shape");
  if (header.descr != "<f8")
    return bad("holds numbers of type " + Quoted(header.descr) + ", expected '<f8' (save it as float64)");
  if (header.shape.size() != 2) return bad("has the shape " + ShapeText(header.shape) + ", expected rows and columns");
  const std::string_view data = bytes.substr(prefix + length);
  const std::uint64_t rows = header.shape[0];
  const std::uint64_t columns = header.shape[1];
  // Without a product, which may be too large.
  const std::uint64_t count = data.size() / sizeof(double);
  if (rows == 0 || columns == 0 || rows > count || columns != count / rows || count % rows != 0 ||
      data.size() % sizeof(double) != 0) {
    return bad("has " + std::to_string(data.size()) + " bytes of numbers, expected 8 for each of the shape " +
               ShapeText(header.shape));
  }
  NumberTable table{.rows = rows, .columns = columns, .values = std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = header.fortran_order ? i % rows * columns + i / rows : i;
    table.values[place] = std::bit_cast<double>(ReadU64(data, sizeof(double) * i));
  }
  return table;
}

}  // namespace depthfarm
