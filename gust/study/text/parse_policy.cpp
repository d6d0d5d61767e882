#include "gust/study/text/parse.h"

namespace gust {

StudyPolicy parse_policy(const Table& table, const Study& study, const FindFiles& find) {
  const std::string name = checked_name(table, "name", "a policy");
  const PolicyKind& kind = policy_kind(required_text(table, "kind", "a policy"), table.find("kind")->place);
  std::shared_ptr<const PolicySource> source = kind.read(table, {study.setup, find, table.place});
  std::vector<std::string> members = source->members();
  return {name, kind.name, table.place, std::move(source), std::move(members)};
}

}  // namespace gust
