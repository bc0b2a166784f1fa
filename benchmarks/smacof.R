# R's smacof from random starts, for benchmarks/mds.py: Rscript smacof.R FOLDER STARTS
# Reads data.csv (a condensed upper triangle a line); writes space.csv and weights.csv of the best start; prints CPU seconds.
suppressPackageStartupMessages(library(smacof))
arguments <- commandArgs(trailingOnly = TRUE)
folder <- arguments[1]
values <- as.matrix(read.csv(file.path(folder, "data.csv"), header = FALSE))
n <- (1 + sqrt(1 + 8 * ncol(values))) / 2
square <- function(row) {
  d <- matrix(0, n, n)
  d[lower.tri(d)] <- row # column by column below the diagonal is row by row above it
  as.dist(d)
}
sources <- lapply(seq_len(nrow(values)), function(k) square(values[k, ]))
set.seed(1)
best <- NULL
seconds <- system.time(for (start in seq_len(as.integer(arguments[2]))) {
  init <- matrix(rnorm(2 * n), n, 2)
  found <- if (length(sources) == 1) {
    mds(sources[[1]], ndim = 2, type = "ordinal", init = init, itmax = 5000)
  } else {
    smacofIndDiff(sources, ndim = 2, type = "ordinal", constraint = "indscal", init = init, itmax = 5000)
  }
  if (is.null(best) || found$stress < best$stress) best <- found
})
space <- if (length(sources) == 1) best$conf else best$gspace
weights <- if (length(sources) == 1) matrix(1, 1, 2) else t(sapply(best$cweights, diag))
write.table(space, file.path(folder, "space.csv"), sep = ",", row.names = FALSE, col.names = FALSE)
write.table(weights, file.path(folder, "weights.csv"), sep = ",", row.names = FALSE, col.names = FALSE)
cat(seconds[["user.self"]] + seconds[["sys.self"]])
