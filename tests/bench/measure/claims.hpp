/// @file
/// Claims on growth and on ratios, measured: each with its fitted exponent, how sure that is, and whether the claim
/// holds. A claim that does not hold is a row like any other.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pd::bench {

/// y ~ c x^exponent, by least squares over log x and log y.
struct PowerLaw {
  double exponent = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();  ///< 95 % interval of the exponent (Student's t); NaN below 3
  double high = std::numeric_limits<double>::quiet_NaN();
  double last = std::numeric_limits<double>::quiet_NaN();  ///< exponent between the last two points alone
  int points = 0;
};
/// Points that are not positive and finite are left out; NaN where fewer than two distinct x are left.
[[nodiscard]] PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

enum class Verdict {
  holds,      ///< the figure (of an exponent: its whole interval) keeps within the bound
  undecided,  ///< the bound lies within the interval of the exponent
  fails,
  reported,  ///< nothing is claimed; the figure stands for itself
};
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// What was counted of one family as x grew.
struct Growth {
  std::string family;
  std::string counter;   ///< with its unit: "time, ns"
  std::string variable;  ///< what x is: "m"
  std::vector<double> x = {};
  std::vector<double> y = {};
  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

struct Claim {
  std::string name;       ///< "Theorem 2.5"
  std::string statement;  ///< what is claimed, in one line
};

struct Finding {
  Claim claim;
  std::string family;
  std::string counter;
  std::string range;       ///< "m = 256..8192"
  double figure;           ///< the value, or the last one of a growth
  PowerLaw fit = {};       ///< of a growth
  std::string bound = {};  ///< "exponent <= 1.3"; empty where nothing is claimed
  Verdict verdict = Verdict::reported;
  Growth growth = {};  ///< what the exponent was fitted to; empty for a value
};

class ClaimTable {
 public:
  /// A growth whose exponent must not exceed `most`; reported only without it.
  void add_growth(const Claim& claim, Growth growth, std::optional<double> most = {});
  /// A growth whose exponent must lie within `slack` of `expected`.
  void add_order(const Claim& claim, Growth growth, double expected, double slack);
  /// One figure that must not exceed `most`; reported only without it.
  void add_value(const Claim& claim, std::string family, std::string counter, std::string range, double figure,
                 std::optional<double> most = {});

  [[nodiscard]] const std::vector<Finding>& findings() const { return findings_; }
  /// The same rows, those of one claim together; claims in the order in which they first came.
  [[nodiscard]] std::vector<Finding> by_claim() const;
  /// Rows that fail.
  [[nodiscard]] int failures() const;

 private:
  void print(const Finding& finding) const;
  std::vector<Finding> findings_;
};

/// Columns claim,family,counter,range,figure,exponent,low,high,last_doubling,bound,verdict.
[[nodiscard]] std::string to_csv(const std::vector<Finding>& findings);
/// The points behind the exponents: claim,family,counter,variable,x,y.
[[nodiscard]] std::string points_csv(const std::vector<Finding>& findings);
/// One table for each claim under its statement. `preamble` stands above them.
[[nodiscard]] std::string to_markdown(const std::vector<Finding>& findings, const std::string& preamble);

}  // namespace pd::bench
