// SPDX-License-Identifier: BSD-3-Clause
// The result of a command as data: fields with names, units and labels, from which text, JSON and schema are printed.
#pragma once

#include <complex>
#include <functional>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <lockstep/math.h>
#include <lockstep/recorder.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

using Json = nlohmann::ordered_json;

/// A number, or null if it is not finite.
Json json_number(double);

struct Schema;

/// A field of a result, without its value.
struct FieldInfo {
  std::string name, unit, label;                ///< in JSON; "" without one; as text prints it, "": only JSON has it
  std::string_view type{};                      ///< of JSON, "number"; of a list, that of its entries
  int depth = 0;                                ///< 1: a list, 2: a list of lists
  const Schema* of = nullptr;                   ///< the fields of an object
  bool by_name = false;                         ///< objects by their names
  bool whole = false;                           ///< text has all of its entries, however many
  bool optional = false;                        ///< absent from JSON if it is empty
  std::string (*words)(const Json&) = nullptr;  ///< its text; null: the printer's own

  void set(bool FieldInfo::*property) { this->*property = true; }
  void set(std::string (*its)(const Json&)) { words = its; }
};
inline constexpr bool FieldInfo::*kUnlessEmpty = &FieldInfo::optional, FieldInfo::*kWhole = &FieldInfo::whole;

/// The fields of an object, in their order.
struct Schema {
  std::vector<FieldInfo> fields;
};

namespace result_detail {

template <class V>
concept Listed = std::is_same_v<V, std::vector<typename V::value_type>>;
/// Whether a V has objects of type U by their names.
template <class V, class U>
inline constexpr bool kNamed =
    std::is_same_v<V, std::map<std::string, U>> || std::is_same_v<V, std::vector<std::pair<std::string, U>>>;
template <class V>
concept Numbers = std::is_base_of_v<Eigen::DenseBase<V>, V>;
template <class V>
concept Vector = Numbers<V> && V::ColsAtCompileTime == 1;

/// A value as JSON.
template <class V>
Json json_of(const V& value) {
  if constexpr (std::is_floating_point_v<V>) {
    return json_number(value);
  } else if constexpr (std::is_same_v<V, Quat>) {
    return {value.w, value.x, value.y, value.z};
  } else if constexpr (std::is_same_v<V, std::complex<double>>) {
    return {json_number(value.real()), json_number(value.imag())};
  } else if constexpr (Vector<V> || Listed<V>) {
    auto all = Json::array();
    for (const auto& each : value) all.push_back(json_of<typename V::value_type>(each));
    return all;
  } else if constexpr (Numbers<V>) {
    auto rows = Json::array();
    for (Eigen::Index i = 0; i < value.rows(); ++i) {
      Json& row = rows.emplace_back(Json::array());
      for (Eigen::Index k = 0; k < value.cols(); ++k) row.push_back(json_of(value(i, k)));
    }
    return rows;
  } else {
    return value;
  }
}

/// The type of its innermost entries, and how deep they are.
template <class V>
constexpr std::pair<std::string_view, int> type_of() {
  if constexpr (std::is_same_v<V, bool>)
    return {"boolean", 0};
  else if constexpr (std::is_integral_v<V>)
    return {"integer", 0};
  else if constexpr (std::is_floating_point_v<V>)
    return {"number", 0};
  else if constexpr (std::is_same_v<V, Quat> || std::is_same_v<V, std::complex<double>>)
    return {"number", 1};
  else if constexpr (Numbers<V>)
    return {"number", type_of<typename V::Scalar>().second + (Vector<V> ? 1 : 2)};
  else if constexpr (Listed<V>)
    return {type_of<typename V::value_type>().first, type_of<typename V::value_type>().second + 1};
  else if constexpr (std::is_same_v<V, Json>)
    return {"", 0};
  else
    return {"string", 0};
}

}  // namespace result_detail

/// Whether there is nothing in it to print: null, false, no text, no entries.
bool is_empty(const Json&);

template <class T>
class Fields;

/// A field of a T: its name, unit and label, and how it is read: a member, or a function of a T.
template <class T>
struct Field {
  FieldInfo info;
  std::function<Json(const T&)> get;

  Field(FieldInfo of, std::function<Json(const T&)> read) : info(std::move(of)), get(std::move(read)) {}
  /// `more`: its words, kUnlessEmpty, kWhole.
  template <class Get, class... More>
  Field(std::string name, std::string unit, std::string label, Get read, More... more)
      : info{std::move(name), std::move(unit), std::move(label)},
        get([read](const T& t) { return result_detail::json_of(std::invoke(read, t)); }) {
    std::tie(info.type, info.depth) =
        result_detail::type_of<std::remove_cvref_t<std::invoke_result_t<Get, const T&>>>();
    (info.set(more), ...);
  }
  /// A field that is an object, a list of objects, or objects by their names. `of` must stay.
  template <class Get, class U, class... More>
  Field(std::string name, std::string label, Get read, const Fields<U>& of, More... more)
      : info{std::move(name), "", std::move(label), "object", 0, &of.schema()} {
    using V = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>;
    info.by_name = result_detail::kNamed<V, U>;
    info.depth = result_detail::Listed<V> && !info.by_name ? 1 : 0;
    (info.set(more), ...);
    get = [read, &of](const T& t) -> Json {
      const auto& value = std::invoke(read, t);
      if constexpr (result_detail::kNamed<V, U>) {
        Json all = Json::object();
        for (const auto& [key, each] : value) all[key] = of(each);
        return all;
      } else if constexpr (result_detail::Listed<V>) {
        Json all = Json::array();
        for (const auto& each : value) all.push_back(of(each));
        return all;
      } else if constexpr (requires { value.has_value(); }) {
        return value.has_value() ? of(*value) : Json();
      } else {
        return of(value);
      }
    };
  }
};

/// All fields of a T.
template <class T>
class Fields {
 public:
  Fields() = default;
  Fields(std::initializer_list<Field<T>> fields) { *this = Fields().with(fields); }
  Json operator()(const T& t) const {
    Json all = Json::object();
    for (const Field<T>& f : fields_)
      if (Json v = f.get(t); !f.info.optional || !is_empty(v)) all[f.info.name] = std::move(v);
    return all;
  }
  const Schema& schema() const { return schema_; }
  /// The same with more fields,
  Fields with(std::initializer_list<Field<T>> more) const {
    Fields all = *this;
    for (const Field<T>& f : more) all.add(f);
    return all;
  }
  /// with the fields of a part of it.
  template <class Get, class U>
  Fields with(Get read, const Fields<U>& part) const {
    Fields all = *this;
    for (const Field<U>& f : part.fields())
      all.add({f.info, [read, get = f.get](const T& t) { return get(std::invoke(read, t)); }});
    return all;
  }
  const std::vector<Field<T>>& fields() const { return fields_; }
  void add(const Field<T>& f) { fields_.push_back(f), schema_.fields.push_back(f.info); }

 private:
  std::vector<Field<T>> fields_;
  Schema schema_;
};

/// What a command returns: its exit code, and its data, if any.
struct Result {
  int code = kExitOk;
  Json data{};
  const Schema* schema = nullptr;    ///< of the data; null: the command has printed everything
  std::string scene{}, title{};      ///< "" if no scene was read
  std::vector<std::string> files{};  ///< written
  std::vector<Result> each{};        ///< of several scenes, in place of data
  std::string command{};             ///< the whole command line
  std::string brief{};               ///< its text, in place of that of the data; "": none
  bool even_if_quiet = false;        ///< --quiet suppresses the progress only
  bool printed = false;              ///< its text is out: only its document is left

  Result(int exit_code = kExitOk) : code(exit_code) {}  // NOLINT: `return kExitFile;`
  template <class T>
  Result(const Fields<T>& fields, const T& found) : data(fields(found)), schema(&fields.schema()) {}
  template <class T>
  Result(const Loaded& of, const Fields<T>& fields, const T& found) : Result(fields, found) {
    scene = of.scene.file, title = of.title();
  }
  /// Writes a whole file, which is one of its files then. Throws FileError.
  void write(const std::string& file, std::string_view text);
};

/// Lines of cells, the titles first, as CSV.
std::string csv_of(const std::vector<std::vector<std::string>>& lines);

/// "0.1", "-" of null; 0 if it is rounding next to `largest`, or below 1e-30.
std::string number_text(const Json&, double largest = 0);
/// "3 ms", "12.5 s".
std::string time_text(double seconds);
/// A number as text, "" of 0.
std::string unless_zero(const Json&);
/// "no", or no text.
inline std::string only_if_false(const Json& b) { return b == false ? "no" : ""; }
/// No text, so that only JSON and its schema have the field, with its label.
inline std::string json_only(const Json&) { return ""; }
/// "[1, 0, 0]": numbers as text prints them; those that are rounding next to the largest, its own or this one, as 0.
std::string vector_text(const Json&, double largest = 0);

/// The document that --json prints: scene, title, the data, files, and the findings of the command.
Json document_of(const Result&);
/// Lines: the title, and each field with its label and unit. Lists are cut after 40 entries, empty fields are left out.
std::string text_of(const Result&);
/// The lines of fields alone.
std::string text_of(const Schema&, const Json& data);
/// The schema of the documents of a command with these results; `several`: of several scenes too.
Json schema_of(std::span<const Schema* const> results, bool several);

/// Prints a document on standard output. Bytes that are no UTF-8, as names of files may have, are replaced.
void print_document(const Json&);
/// Prints a result: with --json its document; else its text, on standard error if standard output takes the rows
/// (--record -), and with --quiet not at all.
void print(const Result&, const Arguments&);

}  // namespace lockstep
