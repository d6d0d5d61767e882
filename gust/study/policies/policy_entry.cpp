#include "gust/study/policies/policy_entry.h"

namespace gust {

std::vector<double> numbers_or(const Written& written, std::string_view key, std::vector<double> standard,
                               std::string_view of) {
  if (!written) return standard;
  std::vector<double> values;
  read_value(values, *written, key, written.range);
  if (values.size() == standard.size()) return values;
  throw error_at(written->place, "'", key, "' must have ", standard.size(),
                 standard.size() == 1 ? " number" : " numbers", of.empty() ? "" : cat(" (", of, ")"), ", got ",
                 values.size());
}

}  // namespace gust
