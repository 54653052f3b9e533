/// @file
/// What an audit found: counts and errors by kind of shapes, the worst contacts, refused lines. Bounded, whatever the
/// length of the record.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "audit/contact_judge.hpp"
#include "audit/error_quantiles.hpp"
#include "support/refusal.hpp"

namespace pd::audit {

/// The columns that hold lengths.
enum class Column : std::uint8_t {
  depth_error,
  depth_error_of_smaller,
  depth_error_absolute,
  normal_excess,
  point_error,
};
inline constexpr std::array kColumns{Column::depth_error, Column::depth_error_of_smaller, Column::depth_error_absolute,
                                     Column::normal_excess, Column::point_error};
[[nodiscard]] std::string_view to_string(Column column);
/// The column of a judgement.
[[nodiscard]] const std::optional<double>& value_of(const Judgement& judgement, Column column);

struct Totals {
  std::int64_t contacts = 0;  ///< read; judged + unanswered
  std::int64_t judged = 0;
  std::int64_t missed = 0;
  std::int64_t phantom = 0;
  std::int64_t unanswered = 0;
  std::int64_t normals_turned = 0;  ///< reported normals and depths that fit with the other sign only
  std::int64_t depths_turned = 0;
  std::array<ErrorQuantiles, kColumns.size()> errors;  ///< of absolute values

  [[nodiscard]] const ErrorQuantiles& of(Column column) const { return errors[static_cast<std::size_t>(column)]; }
  void add(const Judgement& judgement);
};

/// A contact that is kept because few are worse.
struct WorstContact {
  double error = 0;         ///< relative to L, absolute value
  std::string_view column;  ///< that it stands in; "missed" where nothing was reported
  std::int64_t line = 0;
  std::string text;         ///< the line
  RecordedContact contact;  ///< its shapes live as long as the record's table
};

struct RefusedLine {
  std::int64_t line = 0;
  query::Refusal refusal;
};

/// Errors kept of a record; more are only counted.
inline constexpr std::size_t kKeptRefusals = 100;

class AuditSummary {
 public:
  explicit AuditSummary(std::size_t worst_kept) : worst_kept_(worst_kept) {}

  /// In the order of the lines.
  void add(const RecordedContact& contact, const Judgement& judgement, std::int64_t line, const std::string& text);
  void refuse(std::int64_t line, const query::Refusal& refusal, bool contact = false);

  [[nodiscard]] const Totals& total() const { return total_; }
  /// "box-convex": the two kinds in alphabetical order.
  [[nodiscard]] const std::map<std::string, Totals>& by_kind() const { return by_kind_; }
  /// The worst first; of equal ones the earlier.
  [[nodiscard]] const std::vector<WorstContact>& worst() const { return worst_; }
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Those of the refused lines that name a contact.
  [[nodiscard]] std::int64_t refused_contacts() const { return refused_contacts_; }
  [[nodiscard]] const std::vector<RefusedLine>& refusals() const { return refusals_; }
  [[nodiscard]] bool all_judged() const { return refused_ == 0 && total_.unanswered == 0; }

 private:
  std::size_t worst_kept_;
  Totals total_;
  std::map<std::string, Totals> by_kind_;
  std::vector<WorstContact> worst_;
  std::int64_t refused_ = 0;
  std::int64_t refused_contacts_ = 0;
  std::vector<RefusedLine> refusals_;
};

/// "box-convex".
[[nodiscard]] std::string kind_of(const RecordedContact& contact);

}  // namespace pd::audit
