// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/read.h"

#include <algorithm>
#include <boost/algorithm/string/split.hpp>
#include <cmath>
#include <limits>

#include <lockstep/finding.h>
#include <lockstep/text.h>
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {
namespace {

std::string quoted(const std::string& text) {
  constexpr std::size_t kMost = 40;
  std::string shown = "\"";
  for (const char c : text.substr(0, kMost)) shown += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return shown + (text.size() > kMost ? "...\"" : "\"");
}

[[noreturn]] void refuse_form(const Value& v, const std::string& context, const std::string& expected) {
  refuse(v.where, context, "expected " + expected + ", got " + shown(v));
}

std::string number_words(Unit unit) {
  if (unit == Unit::none) return "a number";
  const std::string si = si_unit(unit);
  return article_name_of(unit) + " (a number" + (si.empty() ? "" : " in " + si) + ", or a text such as \"" +
         example_of(unit) + "\")";
}

const Value::List& read_list(const Value& v, std::size_t n, const std::string& context, const std::string& expected) {
  const Value::List* items = v.list();
  if (items == nullptr || (n > 0 && items->size() != n)) refuse_form(v, context, expected);
  return *items;
}

// Its context costs more than the number: it is made where that is not plain.
double read_item(const Value::List& items, std::size_t i, Unit unit, const std::string& context) {
  const double* x = items[i].number();
  return x != nullptr && std::isfinite(*x) ? *x : read_number(items[i], unit, item(context, i));
}

std::string nine_digits(double x) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, x, std::chars_format::general, 9).ptr};
}

// A quaternion's length off 1 that cannot be meant as one; its reader says what is less, and more than rounding.
constexpr double kOffUnit = 0.1;

Quat read_quaternion(const Value& v, const std::string& context) {
  const std::vector<double> c = read_numbers(v, Unit::none, context);
  const Vec4 e(c[0], c[1], c[2], c[3]);
  const double most = e.cwiseAbs().maxCoeff();
  if (most == 0)
    refuse(v.where, context, "the quaternion [0, 0, 0, 0] is not an orientation; [1, 0, 0, 0] is the identity");
  const Vec4 scaled = e / most;  // first, so that its square does not underflow
  const Quat q = normalized(Quat::from(scaled));
  const double length = most * scaled.norm();
  if (std::abs(length - 1) > kOffUnit)
    refuse(v.where, context,
           "the quaternion has length " + text::brief(length) + ", which is more than " + text::brief(100 * kOffUnit) +
               " % off 1; to normalise it, write [" + nine_digits(q.w) + ", " + nine_digits(q.x) + ", " +
               nine_digits(q.y) + ", " + nine_digits(q.z) + "] (scalar first)");
  return q;
}

// The member `wanted` of an orientation's object, without which `key` means nothing.
const Value& partner(const Value& v, const char* key, const char* wanted, const std::string& context) {
  if (const Value* found = v.find(wanted)) return *found;
  refuse(v.where, context, std::string("\"") + key + "\" needs \"" + wanted + "\" as well; add it");
}

Quat read_turn(const Value& v, const std::string& context) {
  const Vec3 n = read_axis(partner(v, "angle", "axis", context), part_of(context, "axis"));
  const Value& given = partner(v, "axis", "angle", context);
  const std::string whose = part_of(context, "angle");
  const double angle = read_number(given, Unit::angle, whose);
  if (given.number() != nullptr && std::abs(angle) > kTwoPi)
    report_finding({.kind = &finding::implausible,
                    .thing = whose,
                    .message = whose + " is " + text::brief(angle) + " rad, more than a revolution",
                    .advice = "if degrees are meant, write \"" + text::brief(angle) + " deg\"",
                    .value = angle,
                    .unit = "rad",
                    .place = given.where.text()});
  return axis_angle(n, angle);
}

Quat read_angle_orientation(const Value& v, const std::string& context) {
  const Vec3 angles = read_vector3(partner(v, "sequence", "angles", context), Unit::angle, context + ".angles");
  const Value& sequence = partner(v, "angles", "sequence", context);
  try {
    return from_angles(read_text(sequence, context + ".sequence"), angles);
  } catch (const ModelError& error) {
    refuse(sequence.where, context + ".sequence", error.what());
  }
}

Quat read_matrix_orientation(const Value& object, const std::string& owner) {
  constexpr double kLimit = 1e-6;
  const Value& v = *object.find("matrix");
  const std::string context = part_of(owner, "matrix");
  const Mat3 A = read_matrix3(v, Unit::none, context);
  const double off = (A.transpose() * A - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kLimit))
    refuse(v.where, context,
           "the columns are not orthonormal: off by " + text::brief(off) + ", allowed is " + text::brief(kLimit) +
               "; give a quaternion or two directions instead");
  if (A.col(0).dot(cross(A.col(1), A.col(2))) < 0)
    refuse(v.where, context,
           "the matrix is a reflection (determinant -1), not a rotation; change the sign of one column");
  return quaternion_of(A);
}

Quat read_direction_orientation(const Value& v, const std::string& context) {
  constexpr double kSkew = 1e-3;  // rad; what numbers of three digits leave is made perpendicular
  const char* names[] = {"x", "y", "z"};
  std::vector<int> k;
  for (int i = 0; i < 3; ++i)
    if (v.find(names[i]) != nullptr) k.push_back(i);
  if (k.size() != 2)
    refuse(v.where, context,
           "it gives " + std::to_string(k.size()) + " of the directions \"x\", \"y\", \"z\"; give two of them");
  const Vec3 first = read_axis(*v.find(names[k[0]]), part_of(context, names[k[0]]));
  const Vec3 given = read_axis(*v.find(names[k[1]]), part_of(context, names[k[1]]));
  const Vec3 upright = given - first.dot(given) * first;
  if (upright.norm() < 1e-6)
    refuse(v.where, context,
           std::string("the directions \"") + names[k[0]] + "\" and \"" + names[k[1]] +
               "\" are parallel; change one of them");
  if (std::abs(first.dot(given)) > kSkew)
    refuse(v.where, context,
           std::string("the directions \"") + names[k[0]] + "\" and \"" + names[k[1]] + "\" are " +
               text::brief(std::acos(first.dot(given)) * 180 / kPi) +
               " deg apart; axes are perpendicular: change one of "
               "them");
  const Vec3 second = upright.normalized();
  Mat3 A;
  A.col(k[0]) = first;
  A.col(k[1]) = second;
  const int third = 3 - k[0] - k[1];
  A.col(third) = (k[1] == (k[0] + 1) % 3 ? 1.0 : -1.0) * cross(first, second);
  return quaternion_of(A);
}

// Rejects members that this form of orientation does not have.
void check_members(const Value& v, std::span<const std::string> known, const std::string& context) {
  for (const Value::Member& member : *v.object())
    if (std::ranges::find(known, member.key) == known.end())
      refuse(member.where, context, "unknown key " + quoted(member.key) + text::suggestion(member.key, known));
}

}  // namespace

void refuse(const SourceLocation& where, const std::string& context, const std::string& problem, ErrorData about) {
  const std::string place = where.text();
  std::string message = place.empty() ? "" : place + ": ";
  if (!context.empty()) message += context + ": ";
  about.file = where.file ? *where.file : std::string(), about.line = where.line, about.column = where.column;
  if (about.problem.empty()) about.problem = problem;
  throw SceneError(message + problem, std::move(about));
}

Value read_word(const std::string& word) {
  if (word == "true" || word == "false") return word == "true";
  const auto x = number_in<double>(word);
  return x ? Value(*x) : Value(word);
}

std::vector<std::string> split_at(char mark, const std::string& text) {
  std::vector<std::string> parts;
  return boost::split(parts, text, [mark](char c) { return c == mark; });
}

std::vector<std::string> words_at(char mark, const std::string& text) {
  std::vector<std::string> words = split_at(mark, text);
  for (std::string& word : words) word = std::string(text::trimmed(word));
  return words;
}

std::string shown(const Value& v) {
  if (const std::string* text = v.text()) return "a text (" + quoted(*text) + ")";
  if (const double* x = v.number()) return "a number (" + text::number(*x) + ")";
  return v.kind();
}

double read_number(const Value& v, Unit unit, const std::string& context) {
  if (const std::string* text = v.text()) {
    const Measured quantity = read_quantity(*text, unit);
    if (!quantity.problem.empty()) refuse(v.where, context, quantity.problem);
    return quantity.value;
  }
  const double* x = v.number();
  if (x == nullptr) refuse_form(v, context, number_words(unit));
  if (!std::isfinite(*x)) refuse(v.where, context, "the number is " + text::number(*x) + "; give a finite one");
  return *x;
}

int read_integer(const Value& v, const std::string& context) {
  const Measured pure = v.text() != nullptr ? read_quantity(*v.text(), Unit::none) : Measured{0, "none"};  // "3 1"
  const double* x = pure.problem.empty() ? &pure.value : v.number();
  if (x == nullptr || !(std::floor(*x) == *x)) refuse_form(v, context, "a whole number");
  if (std::abs(*x) > std::numeric_limits<int>::max())
    refuse(v.where, context,
           "the number " + text::number(*x) + " is too large; the limit is " +
               std::to_string(std::numeric_limits<int>::max()));
  return static_cast<int>(*x);
}

bool read_boolean(const Value& v, const std::string& context) {
  const bool* b = v.boolean();
  if (b == nullptr) refuse_form(v, context, "true or false");
  return *b;
}

std::string read_text(const Value& v, const std::string& context) {
  const std::string* text = v.text();
  if (text == nullptr) refuse_form(v, context, "a text in quotes");
  return *text;
}

std::string read_choice(const Value& v, std::span<const std::string> choices, const std::string& context) {
  std::vector<std::string> names;
  for (const std::string& choice : choices) names.push_back("\"" + choice + "\"");
  const std::string* text = v.text();
  if (text == nullptr) refuse_form(v, context, text::join(names, " or "));
  for (const std::string& choice : choices)
    if (*text == choice) return choice;
  const std::string near = text::closest_name(*text, choices);
  refuse(v.where, context,
         "expected " + text::join(names, " or ") + ", got " + shown(v) +
             (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

Vec3 read_vector3(const Value& v, Unit unit, const std::string& context) {
  const Value::List& items = read_list(v, 3, context, "a list of 3 numbers");
  Vec3 x;
  for (std::size_t i = 0; i < 3; ++i) x[static_cast<int>(i)] = read_item(items, i, unit, context);
  return x;
}

std::vector<double> read_numbers(const Value& v, Unit unit, const std::string& context) {
  const Value::List& items = read_list(v, 0, context, "a list of numbers");
  std::vector<double> numbers;
  numbers.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) numbers.push_back(read_item(items, i, unit, context));
  return numbers;
}

std::vector<std::vector<double>> read_points(const Value& v, Unit unit, const std::string& context) {
  const Value::List& items = read_list(v, 0, context, "a list of lists of numbers");
  std::vector<std::vector<double>> points;
  points.reserve(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) points.push_back(read_numbers(items[i], unit, item(context, i)));
  return points;
}

Mat3 read_matrix3(const Value& v, Unit unit, const std::string& context) {
  const Value::List& rows = read_list(v, 3, context, "a list of 3 rows of 3 numbers");
  Mat3 A;
  for (std::size_t i = 0; i < 3; ++i)
    A.row(static_cast<int>(i)) = read_vector3(rows[i], unit, item(context, i)).transpose();
  return A;
}

Vec3 read_axis(const Value& v, const std::string& context) {
  const std::string expected = "a direction (\"x\", \"-y\" or a list of 3 numbers)";
  if (const std::string* text = v.text()) {
    const bool sign = !text->empty() && (text->front() == '-' || text->front() == '+');
    const std::string letter = sign ? text->substr(1) : *text;
    if (letter != "x" && letter != "y" && letter != "z") refuse_form(v, context, expected);
    return (text->front() == '-' ? -1.0 : 1.0) * Vec3::Unit(letter[0] - 'x');
  }
  const Value::List& items = read_list(v, 3, context, expected);
  const bool measured = std::all_of(items.begin(), items.end(), [](const Value& x) { return x.text() != nullptr; });
  const Vec3 n = read_vector3(v, measured ? Unit::any : Unit::none, context);  // a length has a direction too
  const double most = n.cwiseAbs().maxCoeff();
  if (most == 0) refuse(v.where, context, "the axis [0, 0, 0] has no direction; give one that is not zero");
  return (n / most).normalized();
}

Quat read_orientation(const Value& v, const std::string& context) {
  if (v.list() != nullptr && v.list()->size() == 4) return read_quaternion(v, context);
  static const std::pair<std::vector<std::string>, Quat (*)(const Value&, const std::string&)> kForms[] = {
      {{"axis", "angle"}, read_turn},
      {{"angles", "sequence"}, read_angle_orientation},
      {{"matrix"}, read_matrix_orientation},
      {{"x", "y", "z"}, read_direction_orientation}};
  for (const auto& [keys, read] : kForms)
    if (std::ranges::any_of(keys, [&](const std::string& key) { return v.find(key) != nullptr; })) {
      check_members(v, keys, context);
      return read(v, context);
    }
  refuse_form(
      v, context,
      R"(an orientation ([w, x, y, z], {"axis":, "angle":}, {"angles":, "sequence":}, {"matrix":} or two of {"x":, "y":, "z":}))");
}

}  // namespace lockstep
