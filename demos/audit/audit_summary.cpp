#include "audit/audit_summary.hpp"

#include <algorithm>
#include <cmath>

namespace pd::audit {

namespace {

struct Fault {
  double error = 0;
  std::string_view column;
};

/// The largest of a contact's errors relative to L; an error of 0 where nothing is wrong.
Fault worst_fault(const RecordedContact& contact, const Judgement& judgement) {
  if (judgement.missed && !contact.report) return {judgement.lower / judgement.scale, "missed"};
  Fault worst{0, "depth_error"};
  for (const Column column : {Column::depth_error, Column::normal_excess, Column::point_error}) {
    const auto& value = value_of(judgement, column);
    if (value && std::abs(*value) > worst.error) worst = {std::abs(*value), to_string(column)};
  }
  return worst;
}

}  // namespace

std::string_view to_string(Column column) {
  switch (column) {
    case Column::depth_error:
      return "depth_error";
    case Column::depth_error_of_smaller:
      return "depth_error_of_smaller";
    case Column::depth_error_absolute:
      return "depth_error_absolute";
    case Column::normal_excess:
      return "normal_excess";
    case Column::point_error:
      break;
  }
  return "point_error";
}

const std::optional<double>& value_of(const Judgement& judgement, Column column) {
  switch (column) {
    case Column::depth_error:
      return judgement.depth_error;
    case Column::depth_error_of_smaller:
      return judgement.depth_error_of_smaller;
    case Column::depth_error_absolute:
      return judgement.depth_error_absolute;
    case Column::normal_excess:
      return judgement.normal_excess;
    case Column::point_error:
      break;
  }
  return judgement.point_error;
}

std::string kind_of(const RecordedContact& contact) {
  const auto& [first, second] = std::minmax(contact.a->kind, contact.b->kind);
  return first + "-" + second;
}

void Totals::add(const Judgement& judgement) {
  ++contacts;
  if (!judgement.answered) {
    ++unanswered;
    return;
  }
  ++judged;
  missed += judgement.missed ? 1 : 0;
  phantom += judgement.phantom ? 1 : 0;
  normals_turned += judgement.normal_turned ? 1 : 0;
  depths_turned += judgement.depth_turned ? 1 : 0;
  for (const Column column : kColumns) {
    if (const auto& value = value_of(judgement, column)) errors[static_cast<std::size_t>(column)].add(std::abs(*value));
  }
}

void AuditSummary::add(const RecordedContact& contact, const Judgement& judgement, std::int64_t line,
                       const std::string& text) {
  total_.add(judgement);
  by_kind_[kind_of(contact)].add(judgement);
  if (!judgement.answered || worst_kept_ == 0) return;
  const Fault fault = worst_fault(contact, judgement);
  if (fault.error == 0 || (worst_.size() == worst_kept_ && worst_.back().error >= fault.error)) return;
  const auto place =
      std::find_if(worst_.begin(), worst_.end(), [&](const WorstContact& kept) { return kept.error < fault.error; });
  worst_.insert(place, {fault.error, fault.column, line, text, contact});
  if (worst_.size() > worst_kept_) worst_.pop_back();
}

void AuditSummary::refuse(std::int64_t line, const query::Refusal& refusal, bool contact) {
  ++refused_;
  refused_contacts_ += contact ? 1 : 0;
  if (refusals_.size() < kKeptRefusals) refusals_.push_back({line, refusal});
}

}  // namespace pd::audit
