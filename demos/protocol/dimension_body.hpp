/// @file
/// Bodies of any dimension, 2 to 5, as the protocol writes them ("Any dimension").
///
/// The dimension is that of the first point, halfspace or file row met; a query reads it first and then works with
/// `Body<D>` for that D.
#pragma once

#include <string>
#include <vector>

#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/directional_width.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/line/limits.hpp"

namespace pd::query {

/// Dimension of {"points"} | {"points_file"} | {"halfspaces"}.
/// @throws Refusal out_of_range unless it lies in 2..5; unreadable_file, unsupported (files are refused),
/// missing_field.
[[nodiscard]] int read_dimension(const Node& body, const Limits& limits);

/// The body with its affine map applied.
/// @throws Refusal: those of `Body`'s factories, bad_value for rows of another length.
template <int D>
[[nodiscard]] dimension::Body<D> read_dimension_body(const Node& body, const Limits& limits);

/// "affine" of a body, the identity where it is missing.
template <int D>
[[nodiscard]] dimension::AffineMap<D> read_affine_map(const Node& body);

/// Numbers of a row of length `count`.
template <int D>
[[nodiscard]] dimension::Vector<D> read_row(const Node& node);

/// "epsilon" in (0, 1).
[[nodiscard]] double read_epsilon(const Node& line);
/// "backend" (or another key of that meaning): kernel where it is missing.
[[nodiscard]] dimension::Backend read_backend(const Node& line, std::string_view key = "backend");
/// "representation": points or halfspaces.
[[nodiscard]] dimension::Representation read_representation(const Node& line);
/// "side": outer where it is missing.
[[nodiscard]] dimension::Side read_side(const Node& line);

template <int D>
void write_row(const dimension::Vector<D>& row, JsonWriter& answer) {
  answer.begin_array();
  for (int k = 0; k < D; ++k) answer.number(row[k]);
  answer.end_array();
}

/// [n_1, ..., n_d, offset]
template <int D>
void write_halfspace(const dimension::Halfspace<D>& halfspace, JsonWriter& answer) {
  answer.begin_array();
  for (int k = 0; k < D; ++k) answer.number(halfspace.normal[k]);
  answer.number(halfspace.offset).end_array();
}

/// Calls `answer.template operator()<D>()` for the dimension of a body.
template <class Answer>
void for_dimension(int dimension, Answer&& answer) {
  switch (dimension) {
    case 2:
      return answer.template operator()<2>();
    case 3:
      return answer.template operator()<3>();
    case 4:
      return answer.template operator()<4>();
    default:
      return answer.template operator()<5>();
  }
}

}  // namespace pd::query
