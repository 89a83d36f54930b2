//! The assignment problem: pairs of rows and columns with the least total cost.

/// Costs of pairing each row with each column; `None` forbids a pair.
#[derive(Clone, Debug, Default)]
pub struct CostMatrix {
    rows: usize,
    columns: usize,
    costs: Vec<Option<f64>>,
}

impl CostMatrix {
    /// Creates a matrix from the cost of each (row, column), 0 or more.
    pub fn new(
        rows: usize,
        columns: usize,
        mut cost: impl FnMut(usize, usize) -> Option<f64>,
    ) -> Self {
        let pairs = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        Self {
            rows,
            columns,
            costs: pairs.map(|(row, column)| cost(row, column)).collect(),
        }
    }

    fn get(&self, row: usize, column: usize) -> Option<f64> {
        self.costs[row * self.columns + column]
    }

    fn transposed(&self) -> Self {
        Self::new(self.columns, self.rows, |row, column| self.get(column, row))
    }
}

/// Returns the column of each row, each used at most once: the most pairs, and among these the least total cost.
///
/// Rows and columns that no chain of allowed pairs connects do not compete: each connected group is solved by itself with the
/// Hungarian method with potentials (Kuhn 1955, Munkres 1957), which takes rows² · columns steps.
pub fn assign(costs: &CostMatrix) -> Vec<Option<usize>> {
    let mut assigned = vec![None; costs.rows];
    let mut groups = Groups::new(costs);
    for (row, column) in lone_pairs(costs) {
        assigned[row] = Some(column);
        groups.is_row_seen[row] = true;
        groups.is_column_seen[column] = true;
    }
    while let Some((rows, columns)) = groups.next() {
        let group = CostMatrix::new(rows.len(), columns.len(), |row, column| {
            costs.get(rows[row], columns[column])
        });
        for (row, column) in assign_group(&group).into_iter().enumerate() {
            assigned[rows[row]] = column.map(|column| columns[column]);
        }
    }
    assigned
}

/// Returns the pairs that share neither row nor column with another one. They are nearly all where markers are far apart, and
/// found in one pass.
fn lone_pairs(costs: &CostMatrix) -> impl Iterator<Item = (usize, usize)> {
    let mut pairs_of_column = vec![0_u32; costs.columns];
    let mut only_columns = vec![None; costs.rows];
    for (row, only_column) in only_columns.iter_mut().enumerate() {
        let mut pairs = 0;
        for (column, column_pairs) in pairs_of_column.iter_mut().enumerate() {
            if costs.get(row, column).is_some() {
                *column_pairs += 1;
                pairs += 1;
                *only_column = (pairs == 1).then_some(column);
            }
        }
    }
    let rows = only_columns.into_iter().enumerate();
    rows.filter_map(move |(row, only_column)| {
        let column = only_column?;
        (pairs_of_column[column] == 1).then_some((row, column))
    })
}

/// The groups of rows and columns that allowed pairs connect.
struct Groups<'a> {
    costs: &'a CostMatrix,
    is_row_seen: Vec<bool>,
    is_column_seen: Vec<bool>,
    next_row: usize,
}

impl<'a> Groups<'a> {
    fn new(costs: &'a CostMatrix) -> Self {
        Self {
            costs,
            is_row_seen: vec![false; costs.rows],
            is_column_seen: vec![false; costs.columns],
            next_row: 0,
        }
    }

    /// Returns the rows and columns of the next group that has a pair.
    fn next(&mut self) -> Option<(Vec<usize>, Vec<usize>)> {
        while self.next_row < self.costs.rows {
            let row = self.next_row;
            self.next_row += 1;
            if self.is_row_seen[row] {
                continue;
            }
            let group = self.group_of(row);
            if !group.1.is_empty() {
                return Some(group);
            }
        }
        None
    }

    fn group_of(&mut self, row: usize) -> (Vec<usize>, Vec<usize>) {
        let (mut rows, mut columns) = (vec![row], Vec::new());
        self.is_row_seen[row] = true;
        let (mut searched_rows, mut searched_columns) = (0, 0);
        while searched_rows < rows.len() || searched_columns < columns.len() {
            if let Some(&searched) = rows.get(searched_rows) {
                searched_rows += 1;
                for column in 0..self.costs.columns {
                    if !self.is_column_seen[column] && self.costs.get(searched, column).is_some() {
                        self.is_column_seen[column] = true;
                        columns.push(column);
                    }
                }
            } else {
                let column = columns[searched_columns];
                searched_columns += 1;
                for candidate in 0..self.costs.rows {
                    if !self.is_row_seen[candidate] && self.costs.get(candidate, column).is_some() {
                        self.is_row_seen[candidate] = true;
                        rows.push(candidate);
                    }
                }
            }
        }
        (rows, columns)
    }
}

/// Returns the column of each row of a group.
fn assign_group(costs: &CostMatrix) -> Vec<Option<usize>> {
    let rows = costs.rows;
    if rows > costs.columns {
        let rows_of_columns = assign_group(&costs.transposed());
        let mut columns = vec![None; rows];
        for (column, row) in rows_of_columns.into_iter().enumerate() {
            if let Some(row) = row {
                columns[row] = Some(column);
            }
        }
        return columns;
    }
    let largest = costs.costs.iter().flatten().copied().fold(0.0, f64::max);
    let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
    // More than all allowed pairs together, so that a pair more outweighs every saving.
    let forbidden = rows as f64 + 1.0;
    let cost = |row: usize, column: usize| {
        costs
            .get(row, column)
            .map_or(forbidden, |cost| cost * scale)
    };
    let mut search = Search::new(rows, costs.columns);
    for row in 0..rows {
        search.add_row(row, &cost);
    }
    let mut columns = vec![None; rows];
    for (column, row) in search.row_of.iter().enumerate() {
        if let Some(row) = *row
            && costs.get(row, column).is_some()
        {
            columns[row] = Some(column);
        }
    }
    columns
}

/// A partial assignment with its dual variables: no reduced cost `cost − row potential − column potential` is negative,
/// and a pair has a reduced cost of 0.
struct Search {
    row_potentials: Vec<f64>,
    column_potentials: Vec<f64>,
    row_of: Vec<Option<usize>>,
}

impl Search {
    fn new(rows: usize, columns: usize) -> Self {
        Self {
            row_potentials: vec![0.0; rows],
            column_potentials: vec![0.0; columns],
            row_of: vec![None; columns],
        }
    }

    /// Pairs one more row along the cheapest alternating path to a free column (Dijkstra over reduced costs).
    fn add_row(&mut self, row: usize, cost: &impl Fn(usize, usize) -> f64) {
        let columns = self.row_of.len();
        let mut distances = vec![f64::INFINITY; columns];
        let mut previous: Vec<Option<usize>> = vec![None; columns];
        let mut is_visited = vec![false; columns];
        let (mut current_row, mut current_column, mut length) = (row, None, 0.0);
        loop {
            let mut nearest = (f64::INFINITY, usize::MAX);
            for column in (0..columns).filter(|&column| !is_visited[column]) {
                let reduced = cost(current_row, column)
                    - self.row_potentials[current_row]
                    - self.column_potentials[column];
                if length + reduced < distances[column] {
                    distances[column] = length + reduced;
                    previous[column] = current_column;
                }
                if distances[column] < nearest.0 {
                    nearest = (distances[column], column);
                }
            }
            let (distance, column) = nearest;
            if column == usize::MAX {
                // Only costs that are not finite lead here.
                return;
            }
            is_visited[column] = true;
            (length, current_column) = (distance, Some(column));
            match self.row_of[column] {
                Some(paired) => current_row = paired,
                None => break,
            }
        }
        self.row_potentials[row] += length;
        for column in (0..columns).filter(|&column| is_visited[column]) {
            let change = length - distances[column];
            self.column_potentials[column] -= change;
            if let Some(paired) = self.row_of[column] {
                self.row_potentials[paired] += change;
            }
        }
        let mut end = current_column;
        while let Some(column) = end {
            self.row_of[column] = match previous[column] {
                Some(before) => self.row_of[before],
                None => Some(row),
            };
            end = previous[column];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best number of pairs and their cost, by trying everything.
    fn best(costs: &CostMatrix, row: usize, used: u32) -> (usize, f64) {
        if row == costs.rows {
            return (0, 0.0);
        }
        let mut result = best(costs, row + 1, used);
        for column in 0..costs.columns {
            let Some(cost) = costs.get(row, column) else {
                continue;
            };
            if used & (1 << column) != 0 {
                continue;
            }
            let (pairs, total) = best(costs, row + 1, used | (1 << column));
            let found = (pairs + 1, total + cost);
            if found.0 > result.0 || (found.0 == result.0 && found.1 < result.1) {
                result = found;
            }
        }
        result
    }

    #[test]
    fn random_problems_have_the_same_optimum_as_an_exhaustive_search() {
        let mut random = fastrand::Rng::with_seed(1);
        for round in 0..3000 {
            let (rows, columns) = (random.usize(0..6), random.usize(0..6));
            let costs = CostMatrix::new(rows, columns, |_, _| {
                (random.f64() < 0.6).then(|| random.f64() * 0.02)
            });
            let assigned = assign(&costs);
            assert_eq!(assigned.len(), rows);
            let mut used = 0_u32;
            let (mut pairs, mut total) = (0, 0.0);
            for (row, column) in assigned.iter().enumerate() {
                let Some(column) = *column else { continue };
                assert_eq!(used & (1 << column), 0, "{round}");
                used |= 1 << column;
                total += costs.get(row, column).expect("an allowed pair");
                pairs += 1;
            }
            let (most, least) = best(&costs, 0, 0);
            assert_eq!(pairs, most, "{round}");
            assert!((total - least).abs() < 1e-12, "{round}: {total} {least}");
        }
    }
}
