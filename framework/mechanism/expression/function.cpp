#include "framework/mechanism/expression/function.h"

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/params/read.h"
#include "framework/mechanism/params/units.h"

namespace lockstep::expression {

// From the nodes of an expression to terms on numbers; what is constant is computed here.
class FormulaCompiler {
  using Kind = Term::Kind;

 public:
  FormulaCompiler(const Expression& e, const std::vector<std::string>& variables,
                  const std::vector<Constant>& constants, std::vector<Term>& out)
      : e_(e), variables_(variables), constants_(constants), out_(out) {}

  int compile(int i) {
    const Node& n = e_.node(i);
    switch (n.operation) {
      case Operation::number:
        return constant(n.value);
      case Operation::name:
        return named(n);
      case Operation::negate:
        return one(n, Kind::negate);
      case Operation::negation:
        return one(n, Kind::negation);
      case Operation::add:
        return two(n, Kind::add);
      case Operation::subtract:
        return two(n, Kind::subtract);
      case Operation::multiply:
        return two(n, Kind::multiply);
      case Operation::divide:
        return two(n, Kind::divide);
      case Operation::power:
        return power(n);
      case Operation::less:
        return two(n, Kind::less);
      case Operation::less_equal:
        return two(n, Kind::less_equal);
      case Operation::greater:
        return two(n, Kind::less, true);
      case Operation::greater_equal:
        return two(n, Kind::less_equal, true);
      case Operation::equal:
        return two(n, Kind::equal);
      case Operation::unequal: {
        Term t;
        t.kind = Kind::negation, t.a = two(n, Kind::equal);
        return put(t, {t.a});
      }
      case Operation::conjunction:
        return two(n, Kind::conjunction);
      case Operation::disjunction:
        return two(n, Kind::disjunction);
      case Operation::choose: {
        Term t;
        t.kind = Kind::choose;
        t.a = compile(n.children[0]), t.b = compile(n.children[1]), t.c = compile(n.children[2]);
        return put(t, {t.a, t.b, t.c});
      }
      case Operation::component:
        return component(n);
      case Operation::vector:
        e_.refuse(n, "here numbers are expected; a vector stands in geometry only");
      case Operation::call:
        break;
    }
    return call(n);
  }

 private:
  int constant(double x) {
    Term t;
    t.value = x;
    return put(t, {});
  }
  int one(const Node& n, Kind kind) {
    Term t;
    t.kind = kind, t.a = compile(n.children[0]);
    return put(t, {t.a});
  }
  int two(const Node& n, Kind kind, bool exchanged = false) {
    Term t;
    t.kind = kind, t.a = compile(n.children[0]), t.b = compile(n.children[1]);
    if (exchanged) std::swap(t.a, t.b);
    return put(t, {t.a, t.b});
  }

  int power(const Node& n) {
    Term t;
    t.a = compile(n.children[0]), t.b = compile(n.children[1]);
    if (is_constant(t.b) && !is_constant(t.a)) {
      t.kind = Kind::power, t.value = out_.back().value;
      out_.pop_back();
      return put(t, {t.a});
    }
    t.kind = Kind::raise;
    if (!is_constant(t.a)) return put(t, {t.a, t.b});
    const double a = term(t.a).value;
    if (is_constant(t.b)) {
      const double p = std::pow(a, term(t.b).value);
      out_.resize(static_cast<std::size_t>(t.a));
      return constant(p);
    }
    return put(t, {t.a, t.b});
  }

  int call(const Node& n) {
    if (n.function == Function::norm || n.function == Function::dot || n.function == Function::cross)
      e_.refuse(n, std::string(name_of(n.function)) + " is of vectors, and here numbers are expected");
    Term t;
    t.kind = Kind::call, t.function = n.function, t.a = compile(n.children[0]);
    if (n.children.size() == 1) return put(t, {t.a});
    for (std::size_t k = 1; k < n.children.size(); ++k) t.b = compile(n.children[k]), t.a = put(t, {t.a, t.b});
    return t.a;
  }

  const Constant* find(const std::string& name) const {
    for (const Constant& c : constants_)
      if (c.name == name) return &c;
    return nullptr;
  }

  int named(const Node& n) {
    for (std::size_t k = 0; k < variables_.size(); ++k)
      if (variables_[k] == n.name) {
        Term t;
        t.kind = Kind::variable, t.a = static_cast<int>(k);
        out_.push_back(t);
        return static_cast<int>(out_.size()) - 1;
      }
    if (n.name == "pi") return constant(kPi);
    const Constant* c = find(n.name);
    if (c == nullptr) refuse_unknown(n);
    if (c->is_vector) e_.refuse(n, "\"" + n.name + "\" is a point; name a component, as in " + n.name + ".x");
    return constant(c->value[0]);
  }

  int component(const Node& n) {
    const Node& of = e_.node(n.children[0]);
    const Constant* c = of.operation == Operation::name ? find(of.name) : nullptr;
    if (c == nullptr && of.operation == Operation::name) refuse_unknown(of);
    if (c == nullptr || !c->is_vector) e_.refuse(n, "only a point has components");
    return constant(c->value[n.index]);
  }

  [[noreturn]] void refuse_unknown(const Node& n) const {
    std::vector<std::string> known = variables_;
    for (const Constant& c : constants_) known.push_back(c.name);
    known.emplace_back("pi");
    e_.refuse(n, "unknown name \"" + n.name + "\"" + text::suggestion(n.name, known));
  }

  const Term& term(int i) const { return out_[static_cast<std::size_t>(i)]; }
  bool is_constant(int i) const { return term(i).kind == Kind::constant; }

  // Appends a term, or, in place of one of constants only, its value: those constants are the last terms.
  int put(const Term& t, std::initializer_list<int> parts) {
    out_.push_back(t);
    if (parts.size() > 0 && std::all_of(parts.begin(), parts.end(), [&](int i) { return is_constant(i); })) {
      NoWitness witness;
      const double x = TermEvaluation<double, NoWitness>(out_, {}, witness).value(static_cast<int>(out_.size()) - 1);
      out_.resize(static_cast<std::size_t>(std::min(parts)));
      return constant(x);
    }
    return static_cast<int>(out_.size()) - 1;
  }

  const Expression& e_;
  const std::vector<std::string>& variables_;
  const std::vector<Constant>& constants_;
  std::vector<Term>& out_;
};

namespace {

bool switches(const Term& t) {
  if (t.kind == Term::Kind::less || t.kind == Term::Kind::less_equal || t.kind == Term::Kind::equal) return true;
  if (t.kind == Term::Kind::choose || t.kind == Term::Kind::conjunction || t.kind == Term::Kind::disjunction ||
      t.kind == Term::Kind::negation)
    return true;  // of a number, they tell it from zero
  if (t.kind != Term::Kind::call) return false;
  switch (t.function) {
    case Function::abs:
    case Function::sign:
    case Function::floor:
    case Function::ceil:
    case Function::round:
    case Function::mod:
    case Function::min:
    case Function::max:
      return true;
    default:
      return false;
  }
}

// Numbers of the terms that a term is made of.
int parts_of(const Term& t, int (&parts)[3]) {
  using Kind = Term::Kind;
  parts[0] = t.a, parts[1] = t.b, parts[2] = t.c;
  switch (t.kind) {
    case Kind::constant:
    case Kind::variable:
      return 0;
    case Kind::negate:
    case Kind::negation:
    case Kind::power:
      return 1;
    case Kind::choose:
      return 3;
    case Kind::call: {
      const Function f = t.function;
      const bool two = f == Function::atan2 || f == Function::mod || f == Function::min || f == Function::max ||
                       f == Function::hypot;
      return two ? 2 : 1;
    }
    default:
      return 2;
  }
}

/// A formula on a span of the time: whether all that switches in it is decided there.
class Span {
 public:
  Span(const std::vector<Term>& terms, int time, Interval t) : terms_(terms), time_(time), t_(t) {}

  bool decided(int root) { return of(root), decided_; }

 private:
  enum class Truth { no, yes, unknown };

  // The sign of all of a, 0 where it is not known.
  int sign(const Interval& a) {
    const int s = a.lo > 0 ? 1 : a.hi < 0 ? -1 : 0;
    if (s == 0) decided_ = false;
    return s;
  }
  Truth truth(bool known, bool yes) { return !known ? Truth::unknown : yes ? Truth::yes : Truth::no; }

  Truth holds(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::less:
      case Term::Kind::less_equal: {
        const int s = sign(of(t.a) - of(t.b));
        return truth(s != 0, s < 0);
      }
      case Term::Kind::equal:
        return truth(sign(of(t.a) - of(t.b)) != 0, false);
      case Term::Kind::negation: {
        const Truth a = holds(t.a);
        return a == Truth::unknown ? a : truth(true, a == Truth::no);
      }
      case Term::Kind::conjunction: {
        const Truth a = holds(t.a);
        return a == Truth::no ? a : a == Truth::yes ? holds(t.b) : (holds(t.b), a);
      }
      case Term::Kind::disjunction: {
        const Truth a = holds(t.a);
        return a == Truth::yes ? a : a == Truth::no ? holds(t.b) : (holds(t.b), a);
      }
      case Term::Kind::constant:
        return truth(true, t.value != 0);
      default:
        return truth(sign(of(i)) != 0, true);
    }
  }

  Interval steps(const Interval& a) {  // floor
    const double lo = std::floor(a.lo), hi = std::floor(a.hi);
    if (!(lo == hi)) decided_ = false;
    return {lo, hi};
  }

  Interval of(int i) {
    const Term& t = terms_[static_cast<std::size_t>(i)];
    switch (t.kind) {
      case Term::Kind::constant:
        return t.value;
      case Term::Kind::variable:
        return t.a == time_ ? t_ : Interval::everything();
      case Term::Kind::add:
        return of(t.a) + of(t.b);
      case Term::Kind::subtract:
        return of(t.a) - of(t.b);
      case Term::Kind::multiply:
        return of(t.a) * of(t.b);
      case Term::Kind::divide:
        return of(t.a) / of(t.b);
      case Term::Kind::negate:
        return -of(t.a);
      case Term::Kind::power:
        return pow(of(t.a), t.value);
      case Term::Kind::raise:
        return exp(of(t.b) * log(of(t.a)));
      case Term::Kind::choose: {
        const Truth c = holds(t.a);
        if (c != Truth::unknown) return of(c == Truth::yes ? t.b : t.c);
        return hull(of(t.b), of(t.c));
      }
      case Term::Kind::call:
        return call(t);
      default: {
        const Truth c = holds(i);
        return c == Truth::unknown ? Interval(0, 1) : Interval(c == Truth::yes ? 1 : 0);
      }
    }
  }

  Interval call(const Term& t) {
    const Interval x = of(t.a);
    switch (t.function) {
      case Function::sin:
        return sin(x);
      case Function::cos:
        return cos(x);
      case Function::tan:
        return tan(x);
      case Function::asin:
        return asin(x);
      case Function::acos:
        return acos(x);
      case Function::atan:
        return atan(x);
      case Function::atan2:
        return atan2(x, of(t.b));
      case Function::sinh:
        return sinh(x);
      case Function::cosh:
        return cosh(x);
      case Function::tanh:
        return tanh(x);
      case Function::sqrt:
        return sqrt(x);
      case Function::exp:
        return exp(x);
      case Function::log:
        return log(x);
      case Function::abs:
        return sign(x), abs(x);
      case Function::sign: {
        const int s = sign(x);
        return s == 0 ? Interval(-1, 1) : Interval(s);
      }
      case Function::floor:
        return steps(x);
      case Function::ceil:
        return -steps(-x);
      case Function::round:
        return steps(x + Interval(0.5));
      case Function::mod: {
        const Interval y = of(t.b);
        return x - y * steps(x / y);
      }
      case Function::min:
      case Function::max: {
        const Interval y = of(t.b);
        const int s = sign(x - y);
        const bool first = (s < 0) == (t.function == Function::min);
        return s == 0 ? hull(x, y) : first ? x : y;
      }
      case Function::hypot: {
        const Interval y = of(t.b);
        return sqrt(square(x) + square(y));
      }
      default:
        return Interval::everything();
    }
  }

  const std::vector<Term>& terms_;
  int time_;
  Interval t_;
  bool decided_ = true;
};

/// Finds where the decisions of one term change.
class SwitchSearch {
 public:
  SwitchSearch(const std::vector<Term>& terms, int time, int n_variables, int root)
      : terms_(terms), time_(time), root_(root), variables_(static_cast<std::size_t>(n_variables)) {}

  void find(double t0, double t1, std::vector<double>& out) {
    constexpr int kMostInVain = 20'000;  // spans; beyond them, only the ends of a span are looked at
    const double least = 1e-13 * std::max(std::abs(t0), std::abs(t1));
    std::vector<std::pair<double, double>> left = {{t0, t1}};
    int in_vain = 0;
    while (!left.empty()) {
      const auto [a, b] = left.back();
      left.pop_back();
      if (Span(terms_, time_, {a, b}).decided(root_)) continue;
      const double middle = a + 0.5 * (b - a);
      if (b - a > least && a < middle && middle < b && ++in_vain < kMostInVain) {
        left.emplace_back(middle, b), left.emplace_back(a, middle);
        continue;
      }
      const double at = changed(a, b);
      if (t0 < at && at < t1) out.push_back(at), in_vain = 0;
    }
  }

 private:
  std::uint64_t decisions(double t) {
    variables_[static_cast<std::size_t>(time_)] = Time(t, 1.0, 0.0);
    Decisions signature;
    TermEvaluation<Time, Decisions>(terms_, variables_, signature).value(root_);
    return signature.hash;
  }
  // The first number in (a, b] where the decisions are no more those at a; NaN if there is none at b.
  double changed(double a, double b) {
    const std::uint64_t before = decisions(a);
    if (decisions(b) == before) return std::numeric_limits<double>::quiet_NaN();
    for (double middle = a + 0.5 * (b - a); a < middle && middle < b; middle = a + 0.5 * (b - a))
      (decisions(middle) == before ? a : b) = middle;
    return b;
  }

  const std::vector<Term>& terms_;
  int time_, root_;
  std::vector<Time> variables_;
};

}  // namespace

FormulaFunction::FormulaFunction(const std::string& text, const std::vector<std::string>& variables,
                                 const std::vector<Constant>& constants)
    : text_(text), n_variables_(static_cast<int>(variables.size())) {
  std::vector<std::string> names = variables;
  const Expression e(text, names);
  FormulaCompiler(e, variables, constants, terms_).compile(e.root());
  has_switches_ = std::any_of(terms_.begin(), terms_.end(), switches);
  if (is_constant() && !std::isfinite(terms_.back().value)) e.refuse(0, "its value is not finite");
}

bool FormulaFunction::is_constant() const { return terms_.size() == 1 && terms_[0].kind == Term::Kind::constant; }

bool FormulaFunction::reads(int variable) const {
  return std::any_of(terms_.begin(), terms_.end(),
                     [&](const Term& t) { return t.kind == Term::Kind::variable && t.a == variable; });
}

void FormulaFunction::breakpoints(int time, double t0, double t1, std::vector<double>& out) const {
  if (!has_switches_ || !(t0 < t1) || !std::isfinite(t0) || !std::isfinite(t1)) return;
  // Of each term: whether it reads the time, and whether it reads another variable.
  std::vector<char> timed(terms_.size()), other(terms_.size());
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const Term& t = terms_[i];
    if (t.kind == Term::Kind::variable) (t.a == time ? timed : other)[i] = 1;
    int parts[3];
    for (int k = 0, n = parts_of(t, parts); k < n; ++k) {
      timed[i] |= timed[static_cast<std::size_t>(parts[k])];
      other[i] |= other[static_cast<std::size_t>(parts[k])];
    }
  }
  const std::size_t first = out.size(), root = terms_.size() - 1;
  const auto search = [&](std::size_t i) {
    SwitchSearch(terms_, time, n_variables_, static_cast<int>(i)).find(t0, t1, out);
  };
  if (!other[root]) {
    if (timed[root]) search(root);
  } else {
    for (std::size_t i = 0; i < terms_.size(); ++i)
      if (switches(terms_[i]) && timed[i] && !other[i]) search(i);
  }
  const auto begin = out.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, out.end());
  out.erase(std::unique(begin, out.end()), out.end());
}

template double FormulaFunction::operator()(std::span<const double>) const;
template Time FormulaFunction::operator()(std::span<const Time>) const;
template Jet<4> FormulaFunction::operator()(std::span<const Jet<4>>) const;
template Jet<8> FormulaFunction::operator()(std::span<const Jet<8>>) const;

Key constants_key() {
  return {"parameters", Form::any, Unit::none, kOptional,
          "numbers of its formulas by name; those of the scene, in SI, are known too"};
}

std::vector<Constant> read_constants(const Params& p, const std::string& key) {
  std::vector<Constant> all;
  if (!p.has(key)) return all;
  const Value& object = p.value(key);
  if (object.object() == nullptr) p.refuse(key, "expected an object of numbers by name, got " + shown(object));
  for (const Value::Member& m : *object.object()) {
    const std::string place = part_of(part_of(p.owner(), key), m.key);
    std::string problem;
    if (!is_name(m.key, problem)) lockstep::refuse(m.where, place, "\"" + m.key + "\" is no name: " + problem);
    Constant c;
    c.name = m.key, c.is_vector = m.value.list() != nullptr;
    if (c.is_vector) {
      const Vec3 v = read_vector3(m.value, Unit::any, place);
      std::copy(v.begin(), v.end(), c.value);
    } else {
      c.value[0] = read_number(m.value, Unit::any, place);
    }
    all.push_back(std::move(c));
  }
  return all;
}

}  // namespace lockstep::expression
