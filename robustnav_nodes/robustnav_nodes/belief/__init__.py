"""Where the target may be: Bayes' rule over the candidate locations, fed by a detector that errs."""
